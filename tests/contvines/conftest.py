"""The command line as a function, and a file for it."""

import json
import shlex

import pytest

from contvines.command.cli import main
from contvines.store import save
from tests.contvines import fakes


class Runner:
    """`contvines ...`, words or one line."""

    def __init__(self, capsys):
        self.capsys = capsys

    def __call__(self, *words):
        """(exit status, stdout, stderr)."""
        try:
            main([str(word) for word in (shlex.split(words[0]) if len(words) == 1 else words)])
            status = 0
        except SystemExit as end:
            status = end.code or 0
        return (status, *self.capsys.readouterr())

    def ok(self, *words):
        """What a line says that succeeds."""
        status, out, err = self(*words)
        assert status == 0, err
        return out

    def json(self, line):
        """What a line says in JSON."""
        return json.loads(self.ok(f"{line} --json"))


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Runs the command line in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    return Runner(capsys)


@pytest.fixture
def vines(tmp_path):
    save(fakes.pitchfork_graph(), tmp_path / "g.vines")
    return tmp_path / "g.vines"
