"""An open .vines file, which stores the journal of a run and its graph."""

from __future__ import annotations

import json
import os
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..journal import provenance
from ..long_work import HELD
from .on_disk import (
    APPLICATION_ID,
    TAILS,
    VERSION,
    StoreError,
    check_header,
    cut_short,
    damaged,
    digest_of,
    draft_of,
    found_again,
    packed,
    pending,
    printable,
    printable_text,
    publish,
    split,
    unpacked,
)

if TYPE_CHECKING:
    from ..bifurcation.kind import Kind
    from ..graph import Graph
    from ..journal import Kept
    from ..loci.chart import Chart

_SCHEMA = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE entry (
    id INTEGER PRIMARY KEY, kind TEXT NOT NULL, key TEXT NOT NULL, scalars TEXT NOT NULL, digest BLOB NOT NULL,
    UNIQUE (kind, key));
CREATE TABLE array (
    entry INTEGER NOT NULL REFERENCES entry (id) ON DELETE CASCADE,
    name TEXT NOT NULL, dtype TEXT NOT NULL, shape TEXT NOT NULL, data BLOB NOT NULL,
    PRIMARY KEY (entry, name)) WITHOUT ROWID;
"""


_OBJECTS = "SELECT type, name, tbl_name, sql FROM sqlite_master ORDER BY type, name"


def _schema_objects() -> list[tuple[str, str, str, str | None]]:
    """Return type, name, table and SQL definition of each table and index of a .vines file."""
    with closing(sqlite3.connect(":memory:")) as db:
        db.executescript(_SCHEMA)
        return db.execute(_OBJECTS).fetchall()


class Store:
    """An open .vines file, which stores the journal of a run and its graph.

    It is a `contvines.journal.Journal`. Make it by `create`, `open` or `attach`; close it or use it as a context manager.
    """

    def __init__(
        self,
        connection: sqlite3.Connection | None,
        path: Path,
        promised: tuple[str, Mapping[str, Any] | None] | None = None,
    ):
        self._connection = connection
        self.path = path
        self._promised = promised  # fingerprint and study of a file that will be made with its first entry
        self._written: dict[tuple[str, str], tuple[str, dict[str, np.ndarray]]] = {}
        self._version = 0

    @classmethod
    def create(cls, path: str | Path, fingerprint: str, study: Mapping[str, Any] | None = None) -> Store:
        """Make a new file; it becomes visible only when it is complete.

        Parameters
        ----------
        path : path
        fingerprint : str
            Digest of the study; only runs of the same study may use the file.
        study : mapping, optional
            The study, JSON-able, to be stored.

        Raises
        ------
        StoreError
            If the path exists or cannot be written.
        """
        path = Path(path)
        try:
            _make(path, fingerprint, study)
        except FileExistsError:
            raise StoreError(f"{path}: this file exists already; choose another name (option -o).") from None
        return cls(_connected(path, write=True), path)

    @classmethod
    def open(cls, path: str | Path, *, write: bool = False) -> Store:
        """Open an existing file after checking that it is an undamaged .vines file of a known format version.

        Raises
        ------
        StoreError
            If it is not; the file is left untouched.
        """
        path = Path(path)
        check_header(path)
        with cls(_connected(path, write=False), path) as reader:
            reader._check_whole()
        return cls(_connected(path, write=write), path)

    @classmethod
    def attach(cls, path: str | Path, fingerprint: str, study: Mapping[str, Any] | None = None) -> Store:
        """Open the file of a study for writing; if there is none, it is made with its first entry. Arguments as for `create`.

        Raises
        ------
        StoreError
            If the file is invalid, belongs to another study, or cannot be written.
        """
        path = Path(path)
        if not path.exists():
            if not path.parent.is_dir() or not os.access(path.parent, os.W_OK):
                reason = "its folder is read-only" if path.parent.is_dir() else "there is no such folder"
                raise StoreError(f"{path}: cannot be written ({reason}); choose another place with -o.")
            return cls(None, path, (fingerprint, study))
        with cls.open(path) as reader:
            reader.require(fingerprint)
        return cls(_connected(path, write=True), path)

    @property
    def _db(self) -> sqlite3.Connection:
        """The connection; a file that does not exist yet is made now."""
        if self._connection is None:
            if self._promised is None:
                raise StoreError(f"{self.path}: this file has been closed; open it again.")
            with suppress(FileExistsError):  # another run of the same study made it first
                _make(self.path, *self._promised)
            other = Store.attach(self.path, *self._promised)
            self._connection, self._promised = other._connection, None
            return self._db
        return self._connection

    # -- state ---------------------------------------------------------------------------------------------

    def _meta(self, key: str) -> str:
        if self._promised is not None:
            fingerprint, study = self._promised
            return {"fingerprint": fingerprint, "study": json.dumps(study), "finished": "false"}[key]
        with self._guard():
            row = self._db.execute("SELECT value FROM meta WHERE key = ?", (key,)).fetchone()
        if row is None or not isinstance(row[0], str):
            raise damaged(self.path, f"its {key} is missing")
        return row[0]

    @property
    def fingerprint(self) -> str:
        """Digest of the study that the file belongs to."""
        return self._meta("fingerprint")

    def require(self, fingerprint: str) -> None:
        """Check that the file belongs to the study with this fingerprint.

        Raises
        ------
        StoreError
            If it does not.
        """
        if self.fingerprint != fingerprint:
            raise StoreError(
                f"{self.path}: this file belongs to another study (or to this one before it was edited) or to another command; "
                "--fresh sets it aside, -o gives another name."
            )

    @property
    def study(self) -> dict[str, Any] | None:
        """The study given to `create`."""
        return json.loads(self._meta("study"))

    @property
    def made(self) -> dict[str, str]:
        """Provenance of the file (`contvines.journal.provenance`); empty for files of early versions."""
        if self._promised is not None:
            return {}
        with self._guard():
            row = self._db.execute("SELECT value FROM meta WHERE key = 'made'").fetchone()
        found = json.loads(row[0]) if row is not None and isinstance(row[0], str) else {}
        return {str(k): str(v) for k, v in found.items()} if isinstance(found, dict) else {}

    @property
    def finished(self) -> bool:
        """Whether the run that writes the file has finished."""
        return self._meta("finished") == "true"

    @property
    def records(self) -> int:
        """Number of journal records."""
        if self._promised is not None:
            return 0
        with self._guard():
            return self._db.execute("SELECT count(*) FROM entry WHERE kind = 'journal'").fetchone()[0]

    # -- journal -------------------------------------------------------------------------------------------

    def recall(self, key: str) -> dict[str, Any] | None:
        """Return the values recorded under `key`, arrays and JSON values by name; None if there are none."""
        return next((content for _, content in self.entries("journal", key)), None)

    def record(self, key: str, values: Mapping[str, Any]) -> None:
        """Store arrays and JSON values under `key`, in one transaction."""
        with self.transaction():
            self.put("journal", key, values)

    def checkpoint(self, graph: Kept) -> None:
        """Store the graph so far, replacing the one stored before, in one transaction.

        An unfinished graph does not replace a finished one.
        """
        # some numbers are computed only here: before the transaction, in which interrupts are delayed
        entries = list(graph.entries())
        finished = bool(graph.finished)
        with self.transaction():
            if self.finished and not finished:
                return
            # data_version changes when another process has written and may have replaced the entries of this one
            version = self._db.execute("PRAGMA data_version").fetchone()[0]
            if version != self._version:
                self._written.clear()
                self._version = version
            if not self._written:
                self._db.execute("DELETE FROM entry WHERE kind != 'journal'")
            present = {self._write_changed(*entry) for entry in entries}
            for place in self._written.keys() - present:
                self._db.execute("DELETE FROM entry WHERE kind = ? AND key = ?", place)
                del self._written[place]
            self._db.execute("UPDATE meta SET value = ? WHERE key = 'finished'", (json.dumps(finished),))
            if finished and not graph.stopped:  # the journal is not needed any more
                self._db.execute("DELETE FROM entry WHERE kind = 'journal'")

    def _write_changed(self, kind: str, key: str, content: Mapping[str, Any]) -> tuple[str, str]:
        """Write an entry of the graph unless it is unchanged (arrays are never changed in place); return its kind and key."""
        scalars, arrays = split(content)
        written = self._written.get((kind, key))
        if written is None or written[0] != scalars or not _same_arrays(written[1], arrays):
            self.put(kind, key, content)
            self._written[kind, key] = (scalars, arrays)
        return kind, key

    def graph(
        self, *, problems: bool = True, trust: bool = False, kinds: Iterable[Kind] = ()
    ) -> Graph | Chart:
        """Return the graph (or chart) as of the last checkpoint.

        Parameters
        ----------
        problems : bool
            Rebuild the problems of the branches; False: numbers only, which is faster.
        trust : bool
            Import the functions that the file names; see :mod:`contvines.problems.registry`.
        kinds : iterable of Kind
            User-defined kinds of special points whose loci are rebuilt, too.

        Raises
        ------
        StoreError
            If the file holds no valid graph, or its problems cannot be rebuilt.
        """
        from contvines.graph.persistence import OtherEquations, graph_from_entries

        entries: dict[str, dict[str, Any]] = {}
        folders = self._folders()
        for kind, key, content in self._entries("e.kind != 'journal'"):  # one consistent checkpoint
            content_found = found_again(printable(content), folders)
            entries.setdefault(printable_text(kind), {})[printable_text(key)] = content_found
        try:
            if "chart" in entries:
                from contvines.loci.chart import chart_from_entries

                found = chart_from_entries(entries, problems=problems, trust=trust, kinds=kinds)
            else:
                found = graph_from_entries(entries, problems=problems, trust=trust)
            found.origin = {"study": self.study, "made": self.made}
            return found
        except OSError as error:  # a machine file that the graph needs
            raise StoreError(f"{self.path}: {error}.") from None
        except OtherEquations as error:
            raise StoreError(
                f"{self.path}: an older version of contvines made this file, with other unknowns ({error}); its table can be read "
                "(`contvines show`), for its orbits run its study again with --fresh."
            ) from None
        except (AttributeError, IndexError, KeyError, OverflowError, TypeError, ValueError) as error:
            raise StoreError(
                f"{self.path}: this file does not hold a graph as contvines writes it ({error}); "
                "move it away and run again."
            ) from None

    def _folders(self) -> list[Path]:
        """Return the folders to search for machine files that were moved together with this file: its own, and that of its study."""
        folder, source = self.path.resolve().parent, (self.study or {}).get("source")
        study = source.get("study") if isinstance(source, dict) else None
        return [folder, *([(folder / study).resolve().parent] if isinstance(study, str) else [])]

    # -- entries -------------------------------------------------------------------------------------------

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Run the statements inside as one transaction, with interrupts delayed to its end."""
        with HELD, self._guard():
            if self._db.in_transaction:  # left open by an interrupt
                self._db.execute("ROLLBACK")
            try:
                self._db.execute("BEGIN IMMEDIATE")
                yield
                self._db.execute("COMMIT")
            except BaseException:
                self._written.clear()  # it is not certain any more which entries are in the file
                if self._db.in_transaction:
                    self._db.execute("ROLLBACK")
                raise

    def put(self, kind: str, key: str, content: Mapping[str, Any]) -> None:
        """Write one entry, replacing an entry of the same kind and key; call inside `transaction`."""
        scalars, arrays = split(content)
        rows = [(name, *packed(array)) for name, array in sorted(arrays.items())]
        (identity,) = self._db.execute(
            "INSERT INTO entry (kind, key, scalars, digest) VALUES (?1, ?2, ?3, ?4) "
            "ON CONFLICT (kind, key) DO UPDATE SET scalars = ?3, digest = ?4 RETURNING id",
            (kind, key, scalars, digest_of(kind, key, scalars, rows)),
        ).fetchone()
        self._db.execute("DELETE FROM array WHERE entry = ?", (identity,))
        self._db.executemany("INSERT INTO array VALUES (?, ?, ?, ?, ?)", [(identity, *row) for row in rows])

    def entries(
        self, kind: str | None = None, key: str | None = None
    ) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield entries as (key, content) in the order in which they were written; digests are checked.

        Parameters
        ----------
        kind, key : str, optional
            Only entries of this kind, or with this key.
        """
        # the unary plus keeps SQLite from using the index, so that rows come in the order of the table
        wanted = {"+e.kind = ?" if key is None else "e.kind = ?": kind, "e.key = ?": key}
        wanted = {condition: value for condition, value in wanted.items() if value is not None}
        for _, key_, content in self._entries(" AND ".join(wanted) or "1", *wanted.values()):
            yield key_, content

    def _entries(self, condition: str, *values: str) -> Iterator[tuple[str, str, dict[str, Any]]]:
        """Yield entries as (kind, key, content); one statement reads them with their arrays, so that they are consistent."""
        if self._promised is not None:
            return
        with self._guard():
            rows = self._db.execute(
                "SELECT e.id, e.kind, e.key, e.scalars, e.digest, a.name, a.dtype, a.shape, a.data FROM entry e "
                f"LEFT JOIN array a ON a.entry = e.id WHERE {condition} ORDER BY e.id, a.name",
                values,
            )
            for _, parts in groupby(rows, key=lambda row: row[0]):
                yield self._entry(list(parts))

    def _entry(self, rows: list[tuple[Any, ...]]) -> tuple[str, str, dict[str, Any]]:
        _, kind, key, scalars, digest = rows[0][:5]
        arrays = [row[5:] for row in rows if row[5] is not None]
        texts = (kind, key, scalars, *(part for row in arrays for part in row[:3]))
        if not all(isinstance(text, str) for text in texts) or any(
            type(row[3]) is not bytes for row in arrays
        ):
            raise damaged(self.path, "its content is broken")
        if digest != digest_of(kind, key, scalars, arrays):
            raise damaged(self.path, f"the entry {kind} {key!r} has changed since it was written")
        try:
            content = json.loads(scalars)
            content.update((name, unpacked(*row)) for name, *row in arrays)
        except (ValueError, AttributeError, RecursionError):
            raise damaged(self.path, f"the entry {kind} {key!r} is none that contvines writes") from None
        return kind, key, content

    def _check_whole(self) -> None:
        """Check tables, pages, metadata and digests of the whole file; it may have no other tables, indices or triggers than ours.

        Raises
        ------
        StoreError
            If a check fails.
        """
        with self._guard():
            expected = _schema_objects()
            found = self._db.execute(_OBJECTS).fetchmany(len(expected) + 1)
            if found != expected:
                names = {name for kind, name, *_ in found if kind == "table"}
                missing = [name for kind, name, *_ in expected if kind == "table" and name not in names]
                raise damaged(
                    self.path,
                    f"it lacks the table {missing[0]!r}"
                    if missing
                    else "its tables are not those that contvines makes",
                )
            if self._db.execute("PRAGMA quick_check(1)").fetchone()[0] != "ok":
                raise damaged(self.path, "its pages do not fit together")
        _ = self.fingerprint, self.study, self.finished
        for _ in self.entries():
            pass

    @contextmanager
    def _guard(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.OperationalError as error:
            raise StoreError(f"{self.path}: cannot be used now ({error}).") from None
        except (sqlite3.DatabaseError, UnicodeDecodeError, json.JSONDecodeError, RecursionError):
            raise damaged(
                self.path, "it is cut short" if cut_short(self.path) else "its content is broken"
            ) from None

    def settle(self) -> None:
        """Merge the write-ahead log into the file, so that it is a single file, and release free pages."""
        with self._guard():
            self._db.execute("PRAGMA journal_mode=DELETE")
            self._db.execute("VACUUM")

    def tidy(self) -> None:
        """Do the same as `settle` if no other process uses the file and the disk has enough space; otherwise nothing."""
        if self._promised is not None:
            return
        with suppress(sqlite3.OperationalError):
            self._db.execute("PRAGMA busy_timeout=0")
            if self._db.execute("PRAGMA journal_mode=DELETE").fetchone()[0] == "delete":
                self._db.execute("VACUUM")

    def close(self) -> None:
        """Close the file; no data is lost if this is never called."""
        if self._connection is not None:
            self._connection.close()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _make(path: Path, fingerprint: str, study: Mapping[str, Any] | None) -> None:
    """Make a new file; it becomes visible only when it is complete.

    Raises
    ------
    FileExistsError
        If the path exists.
    StoreError
        If it cannot be written.
    """
    draft = draft_of(path)
    try:
        with closing(sqlite3.connect(draft, isolation_level=None)) as db:
            db.executescript(
                "PRAGMA journal_mode=OFF; "
                f"PRAGMA application_id={APPLICATION_ID}; PRAGMA user_version={VERSION}; BEGIN; {_SCHEMA}"
            )
            db.executemany(
                "INSERT INTO meta VALUES (?, ?)",
                [
                    ("fingerprint", fingerprint),
                    ("study", json.dumps(study)),
                    ("finished", "false"),
                    ("made", json.dumps(provenance())),
                ],
            )
            db.execute("COMMIT")
        publish(draft, path)
    except FileExistsError:
        raise
    except (sqlite3.Error, OSError) as error:
        raise StoreError(f"{path}: cannot be written ({error}); choose another place with -o.") from None
    finally:
        with suppress(OSError):
            draft.unlink()


def _connected(path: Path, *, write: bool) -> sqlite3.Connection:
    """Return a connection; it uses SQLite's locks unless no other process can write the file."""
    may_write = os.access(path, os.W_OK) and os.access(path.parent, os.W_OK)
    tails = [tail for tail in TAILS if path.with_name(path.name + tail).exists()]
    if write or (may_write and ("-journal" in tails or not pending(path))):
        mode = "mode=rw"  # for readers, too: SQLite then completes an interrupted write, and leaves no files beside the database
    else:  # there is the log of a live or killed run, or the file is read-only
        mode = "mode=ro" if tails else "immutable=1"
    try:
        db = sqlite3.connect(f"{path.absolute().as_uri()}?{mode}", uri=True, isolation_level=None, timeout=30)
        db.execute("PRAGMA trusted_schema=OFF")
        if write:
            db.execute("PRAGMA journal_mode=WAL")
            db.execute("PRAGMA synchronous=NORMAL")
            db.execute("PRAGMA foreign_keys=ON")
        else:
            db.execute("PRAGMA query_only=ON")
    except sqlite3.Error as error:
        raise StoreError(f"{path}: cannot be opened ({error}).") from None
    return db


def _same_arrays(one: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray]) -> bool:
    return one.keys() == other.keys() and all(one[name] is other[name] for name in one)
