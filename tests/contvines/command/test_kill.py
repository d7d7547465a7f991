"""Kill -9 and Ctrl-C in the middle of work, then the same command again: the result of an undisturbed run."""

import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from contvines.graph import Graph
from contvines.graph.persistence import same_graph
from contvines.store import Store, load
from contvines.store.differences import differences, of_chart
from contvines.survey import load_survey
from tests.contvines.studies import COUPLED, PAPER

pytestmark = pytest.mark.slow

KILLER = Path(__file__).parents[1] / "killer.py"
KILL, STOP = signal.SIGKILL, signal.SIGINT
STUDIES = {
    "absorber": PAPER.replace("depth = 0", "depth = 2") + "[sweep]\ncount = 9\nwithin = [0.9, 1.6]\ntransient = 100\n",
    "coupled": COUPLED + "\n[sweep]\ncount = 9\nwithin = [0.985, 1.0]\ntransient = 150\n",
    "narrow": PAPER.replace("0.55", "0.72").replace("[0.2, 1.2]", "[0.7, 0.8]").replace("depth = 0", "depth = 1")
    + '[survey]\nvary.restitution = [0.75, 0.76, 0.77]\noutcomes = ["covered", "stable:LR"]\n',
}  # fmt: skip
# Lines up to the name of the file
DIAGRAM = "diagram absorber.toml -o d.vines"
CHART = "chart narrow.vines --over friction --within 0.45 0.55 -o c.vines"
SURVEY = "survey narrow.toml --workers 1 -o s.nc"
SWEEP = "sweep absorber.toml --down -o s.csv"
COUPLED_SWEEP = "sweep coupled.toml -o s.csv"


def command(folder, line, *killer):
    program = [str(KILLER), *map(str, killer)] if killer else ["-m", "contvines.command"]
    return subprocess.run(
        [sys.executable, *program, *line.split()], cwd=folder, capture_output=True, text=True
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Folders with the studies, and with the undisturbed result of a line."""
    known = {}

    def made(line):
        if line not in known:
            folder = known[line] = tmp_path_factory.mktemp("whole")
            for name, text in STUDIES.items():
                (folder / f"{name}.toml").write_text(text)
            if line == CHART:
                command(folder, "diagram narrow.toml --no-look")
            assert command(folder, line).returncode == 0
        return known[line]

    return made


POINTS = "all finished points are kept in {}; the same command goes on from there"
LOOKS = "the diagram is kept in {}; the same command looks again"
MACHINES = "all finished machines are kept in {}.unfinished; the same command goes on"
VALUES = "5 of 9 values are kept in {}; the same command goes on from there, from the state reached"


@pytest.mark.parametrize(
    ("line", "blow", "where", "writes", "says"),
    [
        (DIAGRAM, KILL, "before", 5, ""),
        (DIAGRAM, KILL, "inside", 3, ""),
        (DIAGRAM, KILL, "after", 6, ""),
        (DIAGRAM, STOP, "after", 1, POINTS),
        (DIAGRAM, KILL, "look", 0, ""),
        (DIAGRAM, STOP, "look", 0, LOOKS),
        (CHART, KILL, "after", 2, ""),
        (CHART, STOP, "after", 2, POINTS),
        (SURVEY, KILL, "before", 2, ""),
        (SURVEY, STOP, "before", 2, MACHINES),
        (SWEEP, STOP, "before", 5, VALUES),
        (COUPLED_SWEEP, KILL, "after", 5, ""),
    ],
)
def test_work_that_is_stopped_goes_on(whole, tmp_path, line, blow, where, writes, says):
    undisturbed, folder, name = whole(line), tmp_path / "here", line.split()[-1]
    shutil.copytree(undisturbed, folder, ignore=shutil.ignore_patterns(f"{name[0]}.*"))
    path, journal, log = folder / name, folder / f"{name}.unfinished", folder / "log.txt"
    log.touch()
    stopped = command(folder, line, int(blow), where, writes, log)
    assert stopped.returncode == (130 if blow == STOP else -blow), stopped.stderr
    assert says.format(name) in stopped.stderr and "Traceback" not in stopped.stderr
    if where == "look":
        kept = load(path, problems=False)
        assert kept.finished and not kept.looked and not kept.missing
    elif path.suffix == ".vines":
        with Store.open(path) as store:  # whole, and nothing lost but what was in flight
            assert not store.finished
            assert set(log.read_text().split()) <= {key for key, _ in store.entries("journal")}
    else:
        # its header, and rows: a row that is begun is finished before Ctrl-C
        assert len(journal.read_text().splitlines()) == writes + (where == "after" or blow == STOP)
        assert path.exists() == (path.suffix == ".csv")
        with journal.open("a") as file:
            file.write('{"cells": ["0.9')  # a kill in the middle of a line
    again = command(folder, line)
    assert again.returncode == 0
    assert where == "look" or name == "s.nc" or "is unfinished: going on after" in again.stderr
    assert_same(path, undisturbed / name)
    assert not journal.exists()
    if blow == STOP:
        before = path.read_bytes()
        third = command(folder, line)
        assert third.returncode == 0 and third.stdout == again.stdout
        assert path.suffix == ".csv" or "nothing to compute" in third.stderr
        assert path.read_bytes() == before


def assert_same(one, other):
    """The results of two files; loci to rounding: the directions by which one is bordered are chosen anew where it goes on."""
    if one.suffix == ".csv":
        assert one.read_bytes() == other.read_bytes()
    elif one.suffix == ".nc":
        columns, others = (load_survey(path).columns for path in (one, other))
        assert columns.keys() == others.keys()
        for name in columns:
            np.testing.assert_array_equal(columns[name], others[name])
    else:
        mine, undisturbed = (load(path, problems=False) for path in (one, other))
        if isinstance(mine, Graph):
            assert same_graph(mine, undisturbed) and mine.looked and mine.missing == undisturbed.missing
            return
        assert not differences(of_chart(mine), of_chart(undisturbed)) and mine.loci
        for label, locus in mine.loci.items():
            np.testing.assert_allclose(locus.values, undisturbed.loci[label].values, rtol=1e-12)
