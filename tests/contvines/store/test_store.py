"""The store: identity of save and load, the journal, and the files that are refused and left untouched."""

import os
import signal
import sqlite3
import struct
import subprocess
import sys
import tracemalloc

import numpy as np
import pytest

from contvines.command.frame import held
from contvines.graph.persistence import same_graph
from contvines.store import APPLICATION_ID, VERSION, Store, StoreError, load, save
from tests.contvines import fakes


def folder(path):
    return {p.name: p.read_bytes() for p in path.parent.iterdir() if not p.name.endswith("-shm")}


@pytest.mark.parametrize("finished", [True, False])
def test_save_and_load_are_the_identity(path, finished):
    graph = fakes.pitchfork_graph(finished)
    save(graph, path)
    again = load(path)
    assert same_graph(graph, again)
    assert again.finished is finished
    assert list(again.branches) == list(graph.branches)
    assert again.to_dict() == graph.to_dict() or not finished
    assert list(folder(path)) == ["x.vines"]


def test_save_replaces_its_own_file_and_no_other(path):
    for finished in (False, True):
        save(fakes.pitchfork_graph(finished), path)
    assert load(path).finished
    other = path.with_name("notes.txt")
    other.write_text("mine")
    with pytest.raises(StoreError, match=r"notes\.txt: this is not a \.vines file"):
        save(fakes.pitchfork_graph(), other)
    assert other.read_text() == "mine"


def test_journal_returns_what_was_recorded(path):
    content = {
        "points": np.random.default_rng(0).standard_normal((5, 3)),
        "spectrum": np.array([1 + 2j, np.nan]),
        "stable": np.array([True, False]),
        "count": 7,
        "empty": np.zeros((0, 4)),
        "status": "left the interval",
        "deep": {"list": [1, 2.5, None]},
        "value": np.float64(0.1) + np.float64(0.2),
    }
    with Store.create(path, "f") as store:
        assert store.recall("B1/0") is None
        store.record("B1/0", content)
        store.record("B1/0", content)  # the same again is no error
        assert store.records == 1
    with Store.open(path, write=True) as store:
        again = store.recall("B1/0")
        assert again is not None
        assert again.keys() == content.keys()
        for key, value in content.items():
            if isinstance(value, np.ndarray):
                assert again[key].dtype == value.dtype
                assert again[key].shape == value.shape
                assert again[key].tobytes() == value.tobytes()
            else:
                assert again[key] == value
        assert isinstance(again["value"], float)


def test_a_failed_transaction_leaves_nothing(path):
    with Store.create(path, "f") as store:
        with pytest.raises(TypeError):
            store.record("bad", {"array": np.zeros(3), "thing": object()})
        assert store.recall("bad") is None
        assert store.records == 0


def test_checkpoint_keeps_the_journal_until_the_graph_is_finished(path):
    with Store.create(path, "f") as store:
        store.record("a", {"x": 1})
        store.checkpoint(fakes.pitchfork_graph(False))
        assert not store.finished
        assert store.recall("a") == {"x": 1}
        store.checkpoint(fakes.pitchfork_graph(True))
        assert store.finished
        assert store.recall("a") is None


def test_attach_creates_reopens_and_refuses_another_study(path):
    with Store.attach(path, "one", {"a": 1}) as store:
        store.record("k", {"x": 1})
        assert store.study == {"a": 1}
    with Store.attach(path, "one") as store:
        assert store.recall("k") == {"x": 1}
    before = folder(path)
    with pytest.raises(StoreError, match="belongs to another study"):
        Store.attach(path, "two")
    assert folder(path) == before


def one_bit(whole):
    place = whole.index(fakes.pitchfork_graph().branches["B2"].points[:4].tobytes()) + 17
    return whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :]


def short_by(pages):
    return lambda whole: whole[: len(whole) - pages * int.from_bytes(whole[16:18], "big")]


def database(*statements):
    db = sqlite3.connect(":memory:")
    for statement in statements:
        db.execute(statement)
    return lambda whole: db.serialize()


OURS = f"PRAGMA application_id={APPLICATION_ID}", f"PRAGMA user_version={VERSION}"


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda whole: b"a,b\n1,2\n" * 50, "not a .vines file"),
        (lambda whole: b"SQL", "not a .vines file"),
        (lambda whole: b"", "not a .vines file"),
        *((lambda whole, n=n: whole[:n], "not a .vines file") for n in (20, 50, 99)),
        (database("CREATE TABLE mine (x)"), "database of another program"),
        (lambda whole: whole[:60] + struct.pack(">I", VERSION + 1) + whole[64:], "newer contvines"),
        (lambda whole: whole[: len(whole) // 2], "cut short"),
        *((short_by(pages), "cut short") for pages in (1, 2)),
        (lambda whole: whole[:4096] + b"\xaa" * 400 + whole[4496:], "damaged"),
        (one_bit, "has changed since it was written"),
        (database(*OURS, "CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT)"), "lacks the table"),
    ],
)
def test_refused_files_get_a_sentence_and_are_left_untouched(kept, change, sentence):
    kept.write_bytes(change(kept.read_bytes()))
    before = folder(kept)
    for attempt in (
        lambda: load(kept),
        lambda: Store.attach(kept, "f"),
        lambda: Store.open(kept, write=True),
        lambda: save(fakes.pitchfork_graph(), kept),
    )[: 4 if sentence.startswith("not") else 3]:
        with pytest.raises(StoreError) as caught:
            attempt()
        assert sentence in str(caught.value) and "x.vines" in str(caught.value)
    assert folder(kept) == before


def test_missing_file_and_folder_have_their_sentences(tmp_path):
    with pytest.raises(StoreError, match="there is no such file"):
        load(tmp_path / "none.vines")
    with pytest.raises(StoreError, match="cannot be read"):
        load(tmp_path)
    with pytest.raises(StoreError, match="cannot be written"):
        Store.create(tmp_path / "no" / "such" / "x.vines", "f")


KILLED = """
import os, signal, sys
from contvines.store import Store
store = Store.create(sys.argv[1], "old")
for i in range(20):
    store.record(str(i), {"x": i})
os.kill(os.getpid(), signal.SIGKILL)
"""


def killed_and_removed(path):
    """What is left when a run was killed and its file, but not the log beside it, was removed."""
    subprocess.run([sys.executable, "-c", KILLED, str(path)], check=False)
    log = path.with_name(path.name + "-wal")
    assert log.stat().st_size > 0
    path.unlink()
    return log


def test_the_log_of_a_file_that_is_gone_is_not_taken_for_that_of_a_new_one(path):
    killed_and_removed(path)
    with Store.attach(path, "new") as store:
        store.record("mine", {"x": 7})
    with Store.open(path) as store:
        assert store.fingerprint == "new" and [key for key, _ in store.entries("journal")] == ["mine"]
    path.unlink()
    killed_and_removed(path)
    save(fakes.pitchfork_graph(), path)
    assert same_graph(load(path, problems=False), fakes.pitchfork_graph())


def test_a_file_that_does_not_fit_the_log_beside_it_says_so(kept):
    """A finished file that is copied to where a killed run has left its log."""
    whole = kept.read_bytes()
    kept.unlink()
    log = killed_and_removed(kept)
    kept.write_bytes(whole)
    try:
        load(kept)
    except StoreError as error:
        assert "x.vines-wal" in str(error)
        for left in (log, kept.with_name("x.vines-shm")):
            left.unlink(missing_ok=True)
    assert same_graph(load(kept, problems=False), fakes.pitchfork_graph())


# ------------------------------------------------------------------ schemas that are not ours


def _generated(db):
    """Rows that need no room in the file and 200 MB each in memory."""
    db.execute("DROP TABLE array")
    db.execute(
        "CREATE TABLE array (entry INTEGER NOT NULL, name TEXT NOT NULL, dtype TEXT NOT NULL, shape TEXT NOT NULL, "
        "data BLOB GENERATED ALWAYS AS (zeroblob(200000000)) VIRTUAL, PRIMARY KEY (entry, name)) WITHOUT ROWID"
    )
    db.executemany("INSERT INTO array (entry, name, dtype, shape) VALUES (1, ?, '<f8', '[25000000]')", [("a",), ("b",)])  # fmt: skip


def _trigger(db):
    """A write that never ends."""
    db.execute(
        "CREATE TRIGGER t AFTER INSERT ON entry BEGIN INSERT INTO meta WITH RECURSIVE n(i) AS "
        "(SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i, i FROM n; END"
    )


def _view(db):
    db.execute("ALTER TABLE entry RENAME TO hidden")
    db.execute("CREATE VIEW entry AS SELECT * FROM hidden")


@pytest.mark.parametrize(
    "change",
    [
        _generated,
        _trigger,
        _view,
        lambda db: db.execute("CREATE TABLE more (x)"),
        lambda db: db.execute("CREATE INDEX slow ON entry (length(scalars))"),
        lambda db: db.execute("ALTER TABLE meta ADD COLUMN more TEXT"),
    ],
    ids=["generated column", "trigger", "view", "table", "index", "column"],
)
def test_a_schema_that_is_not_ours_is_refused_before_anything_is_read(kept, rewritten, change):
    rewritten(change)
    before = folder(kept)
    tracemalloc.start()
    for attempt in (lambda: load(kept), lambda: Store.open(kept, write=True)):
        with pytest.raises(StoreError, match=r"x\.vines: this file is damaged \(it"):
            attempt()
    assert tracemalloc.get_traced_memory()[1] < 20e6
    tracemalloc.stop()
    assert folder(kept) == before


@pytest.mark.parametrize("links", [True, False])
def test_who_publishes_first_keeps_the_name(path, monkeypatch, links):
    """Somebody else's file appears between the look and the publishing, on file systems with links and without."""
    plain = os.link

    def late(draft, target):
        if not path.exists():
            with monkeypatch.context() as another:  # another process
                another.setattr("os.link", plain)
                another.setattr("os.getpid", lambda: 1)
                with Store.create(path, "first") as store:
                    store.record("mine", {"x": 1})
        if not links:
            raise PermissionError(1, "Operation not permitted")
        plain(draft, target)

    monkeypatch.setattr("os.link", late)
    with pytest.raises(StoreError, match="exists already"):
        Store.create(path, "second")
    monkeypatch.setattr("os.link", plain)
    with Store.open(path) as store:
        assert store.fingerprint == "first" and store.recall("mine") == {"x": 1}
    assert [name for name in folder(path) if not name.endswith("-wal")] == ["x.vines"]


def test_a_name_that_is_taken_is_refused_and_nothing_is_left(kept):
    before = folder(kept)
    with pytest.raises(StoreError, match="exists already"):
        Store.create(kept, "second")
    assert folder(kept) == before and list(before) == ["x.vines"]


def test_files_without_links_are_published_all_the_same(path, monkeypatch):
    def none(*_):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr("os.link", none)
    with Store.create(path, "f") as store:
        store.record("a", {"x": 1})
    with Store.open(path) as store:
        assert store.recall("a") == {"x": 1}


# ------------------------------------------------------------------ several processes at once


def test_an_entry_is_read_as_it_stood_at_one_moment(path):
    """Another process replaces an entry between the reading of the first one and of the second one."""
    with Store.create(path, "f") as writer:
        for key in "abc":
            writer.record(key, {"x": np.full(4, 1.0), "more": np.arange(3)})
        with Store.open(path) as reader:
            entries = reader.entries("journal")
            next(entries)
            for key in "abc":
                writer.record(key, {"x": np.full(5, 2.0)})
            assert [(key, len(content["x"]), content["x"][0]) for key, content in entries] == [
                ("b", 4, 1.0),
                ("c", 4, 1.0),
            ]
            again = reader.recall("c")
            assert again is not None and again["x"].tolist() == [2.0] * 5


def test_a_graph_that_is_finished_is_not_replaced_by_one_that_is_not(path):
    whole = fakes.pitchfork_graph(True)
    part = fakes.pitchfork_graph(False)
    del part.branches["B3"]
    with Store.create(path, "f") as fast, Store.open(path, write=True) as slow:
        fast.checkpoint(whole)
        slow.checkpoint(part)
        assert slow.finished and same_graph(slow.graph(problems=False), whole)
    assert same_graph(load(path, problems=False), whole)


def test_nothing_is_made_until_something_is_kept(path):
    with Store.attach(path, "f", {"a": 1}) as one, Store.attach(path, "f") as other:
        assert one.recall("k") is None and one.records == 0 and not one.finished and one.study == {"a": 1}
        assert not list(one.entries()) and not path.exists()
        one.record("k", {"x": 1})
        other.record("l", {"x": 2})  # made by the other one meanwhile
        assert one.recall("l") == {"x": 2} and other.recall("k") == {"x": 1}
    with Store.attach(path.with_name("y.vines"), "f"):
        pass
    assert list(folder(path)) == ["x.vines"]


FOLDED = """
import resource, signal, sys
from contvines.store import Store
store = Store.open(sys.argv[1], write=True)
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]),) * 2)  # the write that goes beyond ends the process
store.tidy()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no limit of sizes ends a process there")
@pytest.mark.parametrize("size", [600, 5_000, 14_000])
def test_killed_while_its_log_is_folded(path, size):
    """The log of the folding itself, which SQLite leaves, is used by the next reader and removed by the next command."""
    graph = fakes.pitchfork_graph(True)
    with Store.create(path, "f") as store:
        for i in range(40):
            store.record(str(i), {"x": np.full(300, float(i))})
        store.checkpoint(graph)
    done = subprocess.run([sys.executable, "-c", FOLDED, str(path), str(size)], check=False)
    assert done.returncode == -signal.SIGXFSZ
    assert len(folder(path)) > 1
    assert same_graph(load(path, problems=False), graph)
    with held(path, quiet=True):
        pass
    assert list(folder(path)) == ["x.vines"]
    assert same_graph(load(path, problems=False), graph)
