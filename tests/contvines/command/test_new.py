"""Studies that `contvines new` writes are read and begin; the self-test of `contvines doctor` passes; files say with what they were made."""

import json
import platform

import numpy
import pytest

from contvines.command.begin import Kind
from contvines.command.compose import first_orbit
from contvines.command.study import read_study
from contvines.store import Store


@pytest.mark.parametrize("kind", list(Kind))
def test_a_new_study_begins(run, kind, tmp_path):
    if kind is Kind.machine:
        pytest.importorskip("heyoka")
    status, _, err = run("new", kind.value, "-o", "mine.toml")
    assert not status and "contvines diagram mine.toml" in err
    study = read_study("mine.toml")
    assert first_orbit(study) is not None
    low, high = study.within
    assert low < high
    # every field is explained beside it, or in the line above
    fields = [
        line for line in (tmp_path / "mine.toml").read_text().splitlines() if " = " in line and line[0] != "#"
    ]
    assert 2 * sum("#" in line for line in fields) >= len(fields)


def test_a_file_that_is_there_is_kept(run, tmp_path):
    (tmp_path / "flow.py").write_text("mine")
    status, _, err = run("new", "flow")
    assert status == 1 and "flow.py: this file is there already" in err
    assert (tmp_path / "flow.py").read_text() == "mine"
    assert not (tmp_path / "flow.toml").exists()


def test_a_kind_that_is_none_is_refused_with_those_there_are(run):
    status, _, said = run("new", "foo")
    assert status == 2 and said.startswith("contvines: foo: ") and all(kind.value in said for kind in Kind)


def test_the_self_test_passes_and_names_what_computes(run):
    status, out, _ = run("doctor", "--json")
    said = json.loads(out)
    assert not status and said["self_test"]["passed"]
    assert said["numpy"] == numpy.__version__
    assert said["python"] == platform.python_version()
    assert said["extras"]["proofs"] in (True, False)


def test_a_file_says_with_what_it_was_made(run, vines):
    with Store.open(vines) as store:
        assert store.made["numpy"] == numpy.__version__
        assert set(store.made) == {"contvines", "numpy", "scipy", "python", "platform", "core", "date"}
    assert json.loads(run("show", vines, "--json")[1])["made"]["python"] == platform.python_version()


def test_a_file_of_python_is_no_study(run, tmp_path):
    script = tmp_path / "mine.py"
    script.write_text("import contvines\n")
    status, _, err = run("diagram", script)
    assert status == 1 and "this is a file of Python: run it with python" in err
