"""The command line as a function, and a file for it."""

import shlex

import pytest

from contvines.command.cli import main
from contvines.store import save
from tests.contvines import fakes


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Runs `contvines ...`, words or one line, in an empty folder; returns (exit status, stdout, stderr)."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")

    def go(*words):
        if len(words) == 1:
            words = shlex.split(words[0])
        try:
            main([str(w) for w in words])
            status = 0
        except SystemExit as end:
            status = end.code or 0
        out, err = capsys.readouterr()
        return status, out, err

    return go


@pytest.fixture
def vines(tmp_path):
    save(fakes.pitchfork_graph(), tmp_path / "g.vines")
    return tmp_path / "g.vines"
