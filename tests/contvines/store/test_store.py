"""The store: identity of save and load, the journal, and the files that are refused and left untouched."""

import signal
import sqlite3
import struct
import subprocess
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from contvines.command.frame import held
from contvines.graph.persistence import same_graph
from contvines.store import APPLICATION_ID, VERSION, Store, StoreError, load, save
from tests.contvines import fakes


def folder(path: Path) -> dict[str, bytes]:
    return {p.name: p.read_bytes() for p in sorted(path.iterdir()) if not p.name.endswith("-shm")}


@pytest.mark.parametrize("finished", [True, False])
def test_save_and_load_are_the_identity(tmp_path, finished):
    graph = fakes.pitchfork_graph(finished)
    save(graph, tmp_path / "a.vines")
    again = load(tmp_path / "a.vines")
    assert same_graph(graph, again)
    assert again.finished is finished
    assert list(again.branches) == list(graph.branches)
    assert again.to_dict() == graph.to_dict() or not finished
    assert [p.name for p in tmp_path.iterdir()] == ["a.vines"]


def test_save_replaces_its_own_file_and_no_other(tmp_path):
    path = tmp_path / "a.vines"
    save(fakes.pitchfork_graph(False), path)
    save(fakes.pitchfork_graph(True), path)
    assert load(path).finished
    other = tmp_path / "notes.txt"
    other.write_text("mine")
    with pytest.raises(StoreError, match=r"notes\.txt: this is not a \.vines file"):
        save(fakes.pitchfork_graph(), other)
    assert other.read_text() == "mine"


def test_journal_returns_what_was_recorded(tmp_path):
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
    with Store.create(tmp_path / "j.vines", "f") as store:
        assert store.recall("B1/0") is None
        store.record("B1/0", content)
        store.record("B1/0", content)  # the same again is no error
        assert store.records == 1
    with Store.open(tmp_path / "j.vines", write=True) as store:
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


def test_a_failed_transaction_leaves_nothing(tmp_path):
    with Store.create(tmp_path / "j.vines", "f") as store:
        with pytest.raises(TypeError):
            store.record("bad", {"array": np.zeros(3), "thing": object()})
        assert store.recall("bad") is None
        assert store.records == 0


def test_checkpoint_keeps_the_journal_until_the_graph_is_finished(tmp_path):
    with Store.create(tmp_path / "c.vines", "f") as store:
        store.record("a", {"x": 1})
        store.checkpoint(fakes.pitchfork_graph(False))
        assert not store.finished
        assert store.recall("a") == {"x": 1}
        store.checkpoint(fakes.pitchfork_graph(True))
        assert store.finished
        assert store.recall("a") is None


def test_attach_creates_reopens_and_refuses_another_study(tmp_path):
    path = tmp_path / "s.vines"
    with Store.attach(path, "one", {"a": 1}) as store:
        store.record("k", {"x": 1})
        assert store.study == {"a": 1}
    with Store.attach(path, "one") as store:
        assert store.recall("k") == {"x": 1}
    before = folder(tmp_path)
    with pytest.raises(StoreError, match="belongs to another study"):
        Store.attach(path, "two")
    assert folder(tmp_path) == before


def _text(path):
    path.write_text("a,b\n1,2\n" * 50)


def _short(path):
    path.write_bytes(b"SQL")


def _empty(path):
    path.write_bytes(b"")


def _foreign(path):
    with sqlite3.connect(path) as db:
        db.execute("CREATE TABLE mine (x)")
    db.close()


def _newer(path):
    save(fakes.pitchfork_graph(), path)
    data = bytearray(path.read_bytes())
    data[60:64] = struct.pack(">I", VERSION + 1)
    path.write_bytes(data)


def _cut(path):
    save(fakes.pitchfork_graph(), path)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])


def _scrambled(path):
    save(fakes.pitchfork_graph(), path)
    data = bytearray(path.read_bytes())
    data[4096 : 4096 + 400] = b"\xaa" * 400
    path.write_bytes(data)


def _one_bit(path):
    graph = fakes.pitchfork_graph()
    save(graph, path)
    data = bytearray(path.read_bytes())
    needle = graph.branches["B2"].points[:4].tobytes()
    data[data.index(needle) + 17] ^= 1
    path.write_bytes(data)


def _hollow(path):
    with sqlite3.connect(path) as db:
        db.execute(f"PRAGMA application_id={APPLICATION_ID}")
        db.execute(f"PRAGMA user_version={VERSION}")
        db.execute("CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT)")
    db.close()


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (_text, "not a .vines file"),
        (_short, "not a .vines file"),
        (_empty, "not a .vines file"),
        (_foreign, "database of another program"),
        (_newer, "newer contvines"),
        (_cut, "cut short"),
        (_scrambled, "damaged"),
        (_one_bit, "has changed since it was written"),
        (_hollow, "lacks the table"),
    ],
)
def test_refused_files_get_a_sentence_and_are_left_untouched(tmp_path, make, sentence):
    path = tmp_path / "x.vines"
    make(path)
    before = folder(tmp_path)
    for attempt in (
        lambda: load(path),
        lambda: Store.attach(path, "f"),
        lambda: Store.open(path, write=True),
    ):
        with pytest.raises(StoreError) as caught:
            attempt()
        assert sentence in str(caught.value)
        assert "x.vines" in str(caught.value)
    assert folder(tmp_path) == before


def test_missing_file_and_folder_have_their_sentences(tmp_path):
    with pytest.raises(StoreError, match="there is no such file"):
        load(tmp_path / "none.vines")
    with pytest.raises(StoreError, match="cannot be read"):
        load(tmp_path)
    with pytest.raises(StoreError, match="cannot be written"):
        Store.create(tmp_path / "no" / "such" / "x.vines", "f")


def test_a_file_that_names_a_foreign_function_does_not_call_it(tmp_path):
    graph = fakes.pitchfork_graph()
    graph.branches["B1"].description = {"factory": "os:mkdir", "name": "x"}
    save(graph, tmp_path / "a.vines")
    assert load(tmp_path / "a.vines").branches["B1"].problem is None


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


def test_the_log_of_a_file_that_is_gone_is_not_taken_for_that_of_a_new_one(tmp_path):
    path = tmp_path / "x.vines"
    killed_and_removed(path)
    with Store.attach(path, "new") as store:
        store.record("mine", {"x": 7})
    with Store.open(path) as store:
        assert store.fingerprint == "new" and [key for key, _ in store.entries("journal")] == ["mine"]
    path.unlink()
    killed_and_removed(path)
    save(fakes.pitchfork_graph(), path)
    assert same_graph(load(path, problems=False), fakes.pitchfork_graph())


def test_a_file_that_does_not_fit_the_log_beside_it_says_so(tmp_path):
    """A finished file that is copied to where a killed run has left its log."""
    path, copied = tmp_path / "x.vines", tmp_path / "whole.vines"
    save(fakes.pitchfork_graph(), copied)
    killed_and_removed(path)
    path.write_bytes(copied.read_bytes())
    try:
        load(path)
    except StoreError as error:
        assert "x.vines-wal" in str(error)
        for name in ("x.vines-wal", "x.vines-shm"):
            (tmp_path / name).unlink(missing_ok=True)
    assert same_graph(load(path, problems=False), fakes.pitchfork_graph())


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
def test_a_schema_that_is_not_ours_is_refused_before_anything_is_read(tmp_path, change):
    path = tmp_path / "x.vines"
    save(fakes.pitchfork_graph(), path)
    with sqlite3.connect(path) as db:
        change(db)
    db.close()
    before = folder(tmp_path)
    tracemalloc.start()
    for attempt in (lambda: load(path), lambda: Store.open(path, write=True)):
        with pytest.raises(StoreError, match=r"x\.vines: this file is damaged \(it"):
            attempt()
    assert tracemalloc.get_traced_memory()[1] < 20e6
    tracemalloc.stop()
    assert folder(tmp_path) == before


# ------------------------------------------------------------------ several processes at once


def test_an_entry_is_read_as_it_stood_at_one_moment(tmp_path):
    """Another process replaces an entry between the reading of the first one and of the second one."""
    path = tmp_path / "x.vines"
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


def test_a_graph_that_is_finished_is_not_replaced_by_one_that_is_not(tmp_path):
    path = tmp_path / "x.vines"
    whole = fakes.pitchfork_graph(True)
    part = fakes.pitchfork_graph(False)
    del part.branches["B3"]
    with Store.create(path, "f") as fast, Store.open(path, write=True) as slow:
        fast.checkpoint(whole)
        slow.checkpoint(part)
        assert slow.finished and same_graph(slow.graph(problems=False), whole)
    assert same_graph(load(path, problems=False), whole)


def test_nothing_is_made_until_something_is_kept(tmp_path):
    path = tmp_path / "x.vines"
    with Store.attach(path, "f", {"a": 1}) as one, Store.attach(path, "f") as other:
        assert one.recall("k") is None and one.records == 0 and not one.finished and one.study == {"a": 1}
        assert not list(one.entries()) and not path.exists()
        one.record("k", {"x": 1})
        other.record("l", {"x": 2})  # made by the other one meanwhile
        assert one.recall("l") == {"x": 2} and other.recall("k") == {"x": 1}
    with Store.attach(tmp_path / "y.vines", "f"):
        pass
    assert [p.name for p in tmp_path.iterdir()] == ["x.vines"]


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
def test_killed_while_its_log_is_folded(tmp_path, size):
    """The log of the folding itself, which SQLite leaves, is used by the next reader and removed by the next command."""
    path = tmp_path / "x.vines"
    graph = fakes.pitchfork_graph(True)
    with Store.create(path, "f") as store:
        for i in range(40):
            store.record(str(i), {"x": np.full(300, float(i))})
        store.checkpoint(graph)
    done = subprocess.run([sys.executable, "-c", FOLDED, str(path), str(size)], check=False)
    assert done.returncode == -signal.SIGXFSZ
    assert len(list(tmp_path.iterdir())) > 1
    assert same_graph(load(path, problems=False), graph)
    with held(path, quiet=True):
        pass
    assert [p.name for p in tmp_path.iterdir()] == ["x.vines"]
    assert same_graph(load(path, problems=False), graph)
