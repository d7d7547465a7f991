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

pytestmark = pytest.mark.slow

TOP = Path(__file__).parents[1]
README = (TOP / "README.md").read_text(encoding="utf-8")


def command(name):
    found = re.search(rf"<!-- command: {name} -->\n```sh\n(.+?)\n```", README)
    assert found, f"README.md has no command after its marker {name!r}"
    assert "\n" not in found[1]
    return found[1]


def test_main_job_runs_as_written(tmp_path):
    words = shlex.split(command("run").rpartition(" && ")[2])
    assert words[0] == ".venv/bin/contvines"
    words = [str(TOP / w) if w.startswith("examples/") else w for w in words[1:]]
    line = [sys.executable, "-m", "contvines.command", *words]
    here = {**os.environ, "PYTHONPATH": str(TOP)}
    done = subprocess.run(line, cwd=tmp_path, env=here, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "SB1" in done.stdout
    assert sorted(p.name for p in tmp_path.iterdir()) == ["friction.png", "friction.vines"]


def test_both_commands_start_from_a_bare_python():
    for name in ("run", "tests"):
        assert command(name).startswith("python3 -m venv .venv && .venv/bin/pip install ")
    assert " && .venv/bin/python -m pytest" in command("tests")


def test_python_block_runs(tmp_path, monkeypatch):
    block = re.search(r"<!-- run by the tests -->\n```python\n(.+?)```", README, re.DOTALL)
    assert block
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    exec(compile(block[1], "README.md", "exec"), names)
    assert names["graph"].finished
    assert (tmp_path / "absorber.vines").exists()


SMALL = """
[model]
name = "absorber"
restitution = 0.76
friction = 0.5
gravity = 0.211
mass_ratio = 0.006
[start]
word = "LR"
amplitude = 0.72
[continue]
parameter = "amplitude"
within = [0.7, 1.12]
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

    block = re.search(r"## What to do with it\n```sh\n(.+?)```", README, re.DOTALL)
    assert block
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.toml").write_text(SMALL, encoding="utf-8")
    lines = [shlex.split(line, comments=True) for line in block[1].splitlines()]
    assert len(lines) >= 10 and all(words[0] == "contvines" for words in lines)
    for words in lines:
        with pytest.raises(SystemExit) as end:
            main(words[1:])
        said = capsys.readouterr()
        assert not end.value.code, (words, said.err)
        for option, place in itertools.pairwise(words):
            if option in ("--plot", "-o"):
                assert (tmp_path / place).stat().st_size > 1000, words
    assert {"study.vines", "study-atlas.vines", "study-chart.vines", "study-survey.nc"} <= {
        p.name for p in tmp_path.iterdir()
    }


def test_study_block_is_a_good_study():
    from contvines.command.study import check_study

    block = re.search(r"```toml\n(.+?)```", README, re.DOTALL)
    assert block
    assert check_study(tomllib.loads(block[1])).word == "LR"


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


@pytest.mark.parametrize("target", sorted(set(re.findall(r"\]\(((?!http)[^)#]+)\)", README))))
def test_links_lead_somewhere(target):
    assert (TOP / target).exists()


def test_labels_in_the_table_are_the_ones_in_use():
    from contvines.bifurcation.kinds import LABELS

    named = set(re.findall(r"`([A-Z]{2})`", README))
    assert named == set(LABELS.values())


def test_commands_named_are_commands():
    from contvines.command.cli import app

    real = {c.name or c.callback.__name__ for c in app.registered_commands if c.callback}
    named = set(re.findall(r"^contvines (\w+)", README, re.MULTILINE))
    assert named <= real
    rest = README[README.index("`contvines --help` lists the rest") :].split("\n")[0]
    assert named | set(re.findall(r"`(\w+)`", rest)) == real
    reference = (TOP / "docs/reference.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^\| `(\w+)`", reference, re.MULTILINE)) == real
