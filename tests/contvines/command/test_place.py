"""The places of results: failed starts leave nothing, --fresh sets aside the file that is there, runs on one file wait for one another."""

import selectors
import subprocess
import sys

import pytest

from contvines.command.frame import held
from contvines.graph.persistence import same_graph
from contvines.shared.row_journal import Rows
from contvines.store import load
from contvines.survey.work import Row
from tests.contvines.studies import PAPER

STUDY = (
    PAPER.replace("[0.2, 1.2]", "[0.5, 0.62]")
    + "{more}\n[sweep]\ncount = 3\ntransient = 30\n[survey]\nvary.friction = { values = [0.5, 0.55] }\ngaps = 0\n"
)
OTHER = "max_step = 0.02"
DIAGRAM = "diagram s.toml --no-look"
SURVEY = "survey s.toml -o s.nc -q --workers 1"


@pytest.fixture
def study(tmp_path):
    """Writes the study, with more in [continue]."""

    def write(more=""):
        (tmp_path / "s.toml").write_text(STUDY.replace("{more}", more))

    write()
    return write


def names(path):
    return sorted(p.name for p in path.iterdir())


@pytest.mark.parametrize("command", ["diagram", "trace"])
def test_a_failed_start_leaves_nothing_and_the_mended_study_runs(run, tmp_path, study, command):
    study("bounds = { B = [10.0, 20.0] }")  # the start lies outside
    status, _, err = run(f"{command} s.toml -o x.vines -q")
    assert status == 1 and "Traceback" not in err
    assert names(tmp_path) == ["s.toml"]
    study()
    run.ok(f"{command} s.toml -o x.vines -q")
    assert names(tmp_path) == ["s.toml", "x.vines"]


def test_an_edited_study_is_refused_and_fresh_sets_the_old_file_aside(run, tmp_path, study):
    run.ok(DIAGRAM)
    first = load("s.vines", problems=False)
    study(OTHER)
    status, _, err = run(DIAGRAM)
    assert status == 1 and "s.vines: this file belongs to another study" in err and "--fresh" in err
    status, _, err = run(DIAGRAM + " --fresh")
    assert status == 0 and "s.vines is set aside as s.old.vines" in err
    assert not same_graph(load("s.vines", problems=False), first)
    (tmp_path / "s.vines").write_bytes(b"mine")  # what cannot be read is set aside, too
    assert run(DIAGRAM)[0] == 1
    run.ok(DIAGRAM + " --fresh")  # nothing that was set aside is lost
    assert names(tmp_path) == ["s.old.vines", "s.old2.vines", "s.toml", "s.vines"]
    assert same_graph(load("s.old.vines", problems=False), first)
    assert (tmp_path / "s.old2.vines").read_bytes() == b"mine"


@pytest.mark.slow
def test_rows_of_another_study_are_not_lost(run, tmp_path, study):
    """An edited study neither replaces a finished survey nor throws the rows of an unfinished one away; a journal without rows is nothing to lose."""
    run.ok(SURVEY)
    before = (tmp_path / "s.nc").read_bytes()
    study(OTHER)
    status, _, err = run(SURVEY)
    assert status == 1 and "--fresh" in err and (tmp_path / "s.nc").read_bytes() == before

    for command, target in (("sweep", "t.csv"), ("survey", "t.nc")):
        journal, line = tmp_path / f"{target}.unfinished", f"{command} s.toml -o {target} -q"
        kept = Rows(journal, {"contvines": f"unfinished {command}", "of": "another"}, Row)
        with kept as rows:
            rows.keep(Row(1, {}, "another"))
        status, _, err = run(line)
        assert status == 1 and "1 rows of an unfinished" in err and "--fresh" in err
        assert '"index": 1' in journal.read_text()
        run.ok(line + " --fresh")
        assert '"index": 1' in (tmp_path / f"t.old.{target[2:]}.unfinished").read_text()
        (tmp_path / target).unlink()
        with kept:
            pass
        status, _, err = run(line)
        assert status == 0 and "going on" not in err


@pytest.mark.slow
def test_a_survey_that_was_ended_before_its_last_file(run, tmp_path, study):
    """Its NetCDF file is there, the CSV is not, and its rows are still beside it."""
    run.ok(SURVEY)
    whole = {name: (tmp_path / name).read_bytes() for name in names(tmp_path)}
    (tmp_path / "s.csv").unlink()
    (tmp_path / "s.nc.unfinished").write_text("")
    run.ok(SURVEY)
    assert {name: (tmp_path / name).read_bytes() for name in names(tmp_path)} == whole


HOLDING = """
import sys
from pathlib import Path
from contvines.command.frame import held
with held(Path(sys.argv[1]), quiet=False):
    print("held", flush=True)
    sys.stdin.read(1)
"""


@pytest.mark.slow
@pytest.mark.parametrize("end", ["by itself", "killed"])
def test_a_second_run_waits_until_the_first_has_ended(tmp_path, end):
    target, piped = tmp_path / "x.vines", dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    line = [sys.executable, "-c", HOLDING, str(target)]
    first, second = (subprocess.Popen(line, text=True, **piped) for _ in range(2))
    # whichever was first: only one of them holds it, the other one says that it waits
    holds, waits = (first, second) if _says(first, second) is first else (second, first)
    assert "another run is at work on" in waits.stderr.readline()
    assert names(tmp_path) == [".x.vines.lock"]
    if end == "killed":
        holds.kill()
    else:
        holds.communicate("\n")
    holds.wait()
    assert waits.stdout.readline() == "held\n"
    waits.communicate("\n")
    assert waits.returncode == 0
    assert names(tmp_path) == []


def _says(*processes):
    """The process that is the first to say something on its standard output."""
    with selectors.DefaultSelector() as ready:
        for process in processes:
            ready.register(process.stdout, selectors.EVENT_READ, process)
        key, _ = ready.select()[0]
    assert key.data.stdout.readline() == "held\n"
    return key.data


def test_drafts_of_killed_runs_are_removed_and_those_of_others_are_not(tmp_path):
    done = subprocess.Popen([sys.executable, "-c", "pass"])
    done.wait()
    dead, alive = f".x.vines.{done.pid}-3.draft", ".x.vines.1-0.draft"
    for name in (dead, f"{dead}-wal", f".{dead}.{done.pid}-4.draft", alive, ".y.vines.lock"):
        (tmp_path / name).write_text("")
    with held(tmp_path / "x.vines", quiet=True):
        pass
    assert names(tmp_path) == sorted([alive, ".y.vines.lock"])


def test_a_folder_in_which_nothing_can_be_written(run, tmp_path, study):
    """A finished result can be asked for again there."""
    folder = tmp_path / "locked"
    folder.mkdir()
    run.ok(DIAGRAM + " -q -o locked/d.vines")
    folder.chmod(0o500)
    try:
        status, out, _ = run(DIAGRAM + " -o locked/d.vines")
        assert status == 0 and "B1" in out
        assert names(folder) == ["d.vines"]
    finally:
        folder.chmod(0o700)
