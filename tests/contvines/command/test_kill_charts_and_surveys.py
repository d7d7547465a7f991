"""Kill -9 and Ctrl-C in the middle of a chart and of a survey, then the same command again: the result of an undisturbed run."""

import json
import signal
import subprocess
import sys

import numpy as np
import pytest

from contvines.survey import load_survey

pytestmark = pytest.mark.slow

STUDY = """
[model]
name = "absorber"
restitution = 0.76
friction = 0.5
gravity = 0.211
[start]
word = "LR"
amplitude = 0.72
[continue]
parameter = "amplitude"
within = [0.7, 0.8]
depth = 1
[survey]
vary.restitution = [0.75, 0.76, 0.77]
outcomes = ["covered", "stable:LR"]
"""
BLOWS = [signal.SIGKILL, signal.SIGINT]
# the process strikes itself at the n-th piece of work that is kept, before or after that
STRUCK = """
import os, sys
from contvines.command.cli import main
from {module} import {owner}
keep, count = {owner}.{method}, 0
def struck(self, *content):
    global count
    count += 1
    if "{where}" == "before" and count == {n}:
        os.kill(os.getpid(), {blow})
    keep(self, *content)
    if "{where}" == "after" and count == {n}:
        os.kill(os.getpid(), {blow})
{owner}.{method} = struck
main(sys.argv[1:])
"""
RECORDS = {"module": "contvines.store", "owner": "Store", "method": "record"}
ROWS = {"module": "contvines.shared.row_journal", "owner": "Rows", "method": "keep"}


def command(*words):
    return subprocess.run(
        [sys.executable, "-m", "contvines.command", *map(str, words)], capture_output=True, text=True
    )


def struck(blow, n, where, place, *words):
    code = STRUCK.format(blow=int(blow), n=n, where=where, **place)
    done = subprocess.run([sys.executable, "-c", code, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == (130 if blow == signal.SIGINT else -blow), done.stderr
    assert "Traceback" not in done.stderr
    return done


def alike(one, other):
    """Equal, numbers to rounding: the directions by which a locus is bordered are chosen anew where it goes on."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(alike(one[k], other[k]) for k in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(alike, one, other))
    return one == (pytest.approx(other, rel=1e-12, abs=1e-12) if isinstance(one, float) else other)


def shown_of(path):
    """What `show --json` says of a file, but for the date at which it was made."""
    shown = json.loads(command("show", path, "--json").stdout)
    del shown["made"]["date"]
    return shown


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("stopped") / "study.toml"
    path.write_text(STUDY)
    assert command("diagram", path, "--quiet", "--no-look", "-o", path.with_suffix(".vines")).returncode == 0
    return path


@pytest.fixture(scope="module")
def chart(study):
    words = ["chart", study.with_suffix(".vines"), "--over", "friction", "--within", 0.45, 0.55, "-o"]
    whole = study.with_name("whole.vines")
    assert command(*words, whole, "--quiet").returncode == 0
    shown = shown_of(whole)
    assert len(shown["loci"]) >= 1
    return words, shown


@pytest.mark.parametrize("blow", BLOWS)
def test_a_chart_that_is_stopped_goes_on(tmp_path, chart, blow):
    words, whole = chart
    path = tmp_path / "c.vines"
    done = struck(blow, 2, "after", RECORDS, *words, path, "--quiet")
    if blow == signal.SIGINT:
        assert f"all finished points are kept in {path}; the same command goes on" in done.stderr
    again = command(*words, path)
    assert again.returncode == 0 and "is unfinished: going on after 2 finished" in again.stderr
    assert alike(shown_of(path), whole)


@pytest.fixture(scope="module")
def surveyed(study):
    words = ["survey", study, "--workers", 1, "-o"]
    whole = study.with_name("whole.nc")
    assert command(*words, whole, "--quiet").returncode == 0
    return words, load_survey(whole)


@pytest.mark.parametrize("blow", BLOWS)
def test_a_survey_that_is_stopped_goes_on(tmp_path, surveyed, blow):
    words, one = surveyed
    path = tmp_path / "s.nc"
    journal = path.with_name("s.nc.unfinished")
    done = struck(blow, 2, "before", ROWS, *words, path, "--quiet")
    assert (
        len(journal.read_text().splitlines()) == 2 and not path.exists()
    )  # its header, and the first machine
    if blow == signal.SIGINT:
        assert f"all finished machines are kept in {journal}; the same command goes on" in done.stderr
    assert command(*words, path, "--quiet").returncode == 0
    assert not journal.exists()
    other = load_survey(path)
    assert set(one.columns) == set(other.columns)
    for name, column in one.columns.items():
        np.testing.assert_array_equal(column, other.columns[name])
