"""The README's two commands, its code and its names are true."""

import itertools
import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.contvines.studies import PAPER

pytestmark = pytest.mark.slow

TOP = Path(__file__).parents[1]
README = (TOP / "README.md").read_text(encoding="utf-8")


def block(before):
    """What stands in the block of code behind a text."""
    found = re.search(rf"{before}\n```\w+\n(.+?)\n```", README, re.DOTALL)
    assert found, f"README.md has no block of code after {before!r}"
    return found[1]


def test_main_job_runs_as_written(tmp_path):
    words = shlex.split(block("<!-- command: run -->").rpartition(" && ")[2])
    assert words[0] == ".venv/bin/contvines"
    words = [str(TOP / w) if w.startswith("examples/") else w for w in words[1:]]
    line = [sys.executable, "-m", "contvines.command", *words]
    here = {**os.environ, "PYTHONPATH": str(TOP)}
    done = subprocess.run(line, cwd=tmp_path, env=here, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "SB1" in done.stdout
    assert sorted(p.name for p in tmp_path.iterdir()) == ["friction.png", "friction.vines"]


@pytest.mark.parametrize("name", ["run", "tests"])
def test_both_commands_start_from_a_bare_python(name):
    line = block(f"<!-- command: {name} -->")
    assert "\n" not in line and line.startswith("python3 -m venv .venv && .venv/bin/pip install ")
    assert name == "run" or " && .venv/bin/python -m pytest" in line


def test_python_block_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    exec(compile(block("<!-- run by the tests -->"), "README.md", "exec"), names)
    assert names["graph"].finished
    assert (tmp_path / "absorber.vines").exists()


SMALL = """
depth = 1
[atlas]
values = 2
starts = 8
[sweep]
count = 3
transient = 50
[survey]
vary.restitution = [0.75, 0.76]
outcomes = ["covered"]
"""


def test_what_to_do_with_it_can_be_done_line_by_line(tmp_path, monkeypatch, capsys):
    """Every command of the list, as it is written, on a study of one short branch."""
    from contvines.command.cli import main

    monkeypatch.chdir(tmp_path)
    study = PAPER.replace("0.55", "0.72").replace("[0.2, 1.2]", "[0.7, 1.12]").replace("depth = 0\n", SMALL)
    (tmp_path / "study.toml").write_text(study, encoding="utf-8")
    lines = [shlex.split(line, comments=True) for line in block("## What to do with it").splitlines()]
    assert len(lines) >= 10 and all(words[0] == "contvines" for words in lines)
    for words in lines:
        with pytest.raises(SystemExit) as end:
            main(words[1:])
        assert not end.value.code, (words, capsys.readouterr().err)
        for option, place in itertools.pairwise(words):
            if option in ("--plot", "-o"):
                assert (tmp_path / place).stat().st_size > 1000, words
    made = {p.name for p in tmp_path.iterdir()}
    assert {"study.vines", "study-atlas.vines", "study-chart.vines", "study-survey.nc"} <= made


def test_study_block_is_a_good_study():
    from contvines.command.study import check_study

    text = re.search(r"```toml\n(.+?)```", README, re.DOTALL)
    assert text and check_study(tomllib.loads(text[1])).start.word == "LR"


def test_authors_and_version_are_those_of_the_citation():
    """CITATION.cff is filled in first; what else names the authors or the version follows it."""
    import contvines

    citation = (TOP / "CITATION.cff").read_text(encoding="utf-8")
    listed = citation[citation.index("\nauthors:") : citation.index("\nkeywords:")]
    names = re.findall(r'^ +(?:- )?(?:family-names|name): "?([^"\n]+)"?$', listed, re.MULTILINE)
    assert names
    for place in ("README.md", "pyproject.toml", "paper/paper.md", "LICENSE"):
        text = (TOP / place).read_text(encoding="utf-8")
        assert not [name for name in names if name not in text], place
    version = re.search(r"^version: (\S+)$", citation, re.MULTILINE)
    built = tomllib.loads((TOP / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert version and version[1] == contvines.__version__ == built
    assert f"version = {{{version[1]}}}" in README


def test_links_lead_somewhere():
    targets = re.findall(r"\]\(((?!http)[^)#]+)\)", README)
    assert targets and not [target for target in targets if not (TOP / target).exists()]


def test_labels_and_commands_are_the_ones_in_use():
    from contvines.bifurcation.kinds import LABELS
    from contvines.command.cli import COMMANDS

    assert set(re.findall(r"`([A-Z]{2})`", README)) == set(LABELS.values())
    named = set(re.findall(r"^contvines (\w+)", README, re.MULTILINE))
    rest = README[README.index("`contvines --help` lists the rest") :].split("\n")[0]
    assert named <= set(COMMANDS) == named | set(re.findall(r"`(\w+)`", rest))
