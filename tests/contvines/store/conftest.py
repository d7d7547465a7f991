"""A file of a small graph."""

import sqlite3
from contextlib import closing

import pytest

from contvines.store import save
from tests.contvines import fakes


@pytest.fixture
def path(tmp_path):
    return tmp_path / "x.vines"


@pytest.fixture
def kept(path):
    save(fakes.pitchfork_graph(), path)
    return path


@pytest.fixture
def rewritten(kept):
    """Changes the file's database by a function."""

    def go(change):
        with closing(sqlite3.connect(kept)) as db, db:
            change(db)

    return go
