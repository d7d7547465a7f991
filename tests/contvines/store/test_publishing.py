"""How a file gets its name, and files that are not whole."""

import os

import pytest

from contvines.store import Store, StoreError, load, save
from tests.contvines import fakes


def _who_was_first(path):
    with Store.create(path, "first") as store:
        store.record("mine", {"x": 1})


@pytest.mark.parametrize("links", [True, False])
def test_who_publishes_first_keeps_the_name(tmp_path, monkeypatch, links):
    """Somebody else's file appears between the look and the publishing, on file systems with links and without."""
    path = tmp_path / "x.vines"
    plain = os.link

    def late(draft, target):
        if not path.exists():
            with monkeypatch.context() as another:  # another process
                another.setattr("os.link", plain)
                another.setattr("os.getpid", lambda: 1)
                _who_was_first(path)
        if not links:
            raise PermissionError(1, "Operation not permitted")
        plain(draft, target)

    monkeypatch.setattr("os.link", late)
    with pytest.raises(StoreError, match="exists already"):
        Store.create(path, "second")
    monkeypatch.setattr("os.link", plain)
    with Store.open(path) as store:
        assert store.fingerprint == "first" and store.recall("mine") == {"x": 1}
    assert [p.name for p in tmp_path.iterdir() if not p.name.endswith(("-wal", "-shm"))] == ["x.vines"]


def test_a_name_that_is_taken_is_refused_and_nothing_is_left(tmp_path):
    path = tmp_path / "x.vines"
    save(fakes.pitchfork_graph(), path)
    before = path.read_bytes()
    with pytest.raises(StoreError, match="exists already"):
        Store.create(path, "second")
    assert path.read_bytes() == before and os.listdir(tmp_path) == ["x.vines"]


def test_files_without_links_are_published_all_the_same(tmp_path, monkeypatch):
    def none(*_):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr("os.link", none)
    with Store.create(tmp_path / "x.vines", "f") as store:
        store.record("a", {"x": 1})
    with Store.open(tmp_path / "x.vines") as store:
        assert store.recall("a") == {"x": 1}


@pytest.mark.parametrize("pages", [1, 2])
def test_a_file_that_is_short_by_whole_pages_is_refused(tmp_path, pages):
    path = tmp_path / "x.vines"
    save(fakes.pitchfork_graph(), path)
    data = path.read_bytes()
    page = int.from_bytes(data[16:18], "big")
    path.write_bytes(data[: len(data) - pages * page])
    with pytest.raises(StoreError, match="cut short"):
        load(path)


@pytest.mark.parametrize("length", [20, 50, 99])
def test_the_first_bytes_of_a_file_are_no_file(tmp_path, length):
    path = tmp_path / "x.vines"
    save(fakes.pitchfork_graph(), path)
    path.write_bytes(path.read_bytes()[:length])
    with pytest.raises(StoreError, match="not a .vines file"):
        load(path)
    with pytest.raises(StoreError, match="not a .vines file"):
        save(fakes.pitchfork_graph(), path)
