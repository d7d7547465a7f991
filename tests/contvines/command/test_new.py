"""Studies that `contvines new` writes are read and begin; the self-test of `contvines doctor` passes; files say with what they were made."""

import json
import platform

import numpy
import pytest

from contvines.command.cli import main
from contvines.command.compose import first_orbit
from contvines.command.new import Kind
from contvines.command.study import read_study
from contvines.store import Store, save
from tests.contvines import fakes


def call(*words):
    with pytest.raises(SystemExit) as end:
        main([str(word) for word in words])
    return end.value.code


@pytest.mark.parametrize("kind", list(Kind))
def test_a_new_study_begins(kind, tmp_path, monkeypatch, capsys):
    if kind is Kind.machine:
        pytest.importorskip("heyoka")
    monkeypatch.chdir(tmp_path)
    assert not call("new", kind.value, "-o", "mine.toml")
    assert "contvines diagram mine.toml" in capsys.readouterr().err
    study = read_study("mine.toml")
    assert first_orbit(study) is not None
    low, high = study.within
    assert low < high
    # every field is explained beside it, or in the line above
    fields = [
        line for line in (tmp_path / "mine.toml").read_text().splitlines() if " = " in line and line[0] != "#"
    ]
    assert 2 * sum("#" in line for line in fields) >= len(fields)


def test_a_file_that_is_there_is_kept(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "flow.py").write_text("mine")
    assert call("new", "flow") == 1
    assert "flow.py: this file is there already" in capsys.readouterr().err
    assert (tmp_path / "flow.py").read_text() == "mine"
    assert not (tmp_path / "flow.toml").exists()


def test_a_kind_that_is_none_is_refused_with_those_there_are(capsys):
    assert call("new", "foo") == 2
    said = capsys.readouterr().err
    assert said.startswith("contvines: foo: ") and all(kind.value in said for kind in Kind)


def test_the_self_test_passes_and_names_what_computes(capsys):
    assert not call("doctor", "--json")
    said = json.loads(capsys.readouterr().out)
    assert said["self_test"]["passed"]
    assert said["numpy"] == numpy.__version__
    assert said["python"] == platform.python_version()
    assert said["extras"]["proofs"] in (True, False)


def test_a_file_says_with_what_it_was_made(tmp_path, capsys):
    path = tmp_path / "g.vines"
    save(fakes.pitchfork_graph(), path)
    with Store.open(path) as store:
        assert store.made["numpy"] == numpy.__version__
        assert set(store.made) == {"contvines", "numpy", "scipy", "python", "platform", "core", "date"}
    assert not call("show", path, "--json")
    assert json.loads(capsys.readouterr().out)["made"]["python"] == platform.python_version()


def test_a_file_of_python_is_no_study(tmp_path, capsys):
    script = tmp_path / "mine.py"
    script.write_text("import contvines\n")
    assert call("diagram", script) == 1
    assert "this is a file of Python: run it with python" in capsys.readouterr().err
