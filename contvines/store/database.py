"""An open .vines file: the journal of a run and the home of its graph."""

import json
import os
import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from ..interrupts import HELD
from .header import APPLICATION_ID, VERSION, StoreError, check_header, damaged, pending
from .packing import digest_of, packed, split, unpacked
from .publishing import publish

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


class Store:
    """An open .vines file; the journal of a run and the home of its graph.

    Use `create`, `open` or `attach`; close it or use it as a context manager.
    """

    def __init__(self, connection: sqlite3.Connection, path: Path):
        self._db = connection
        self.path = path
        self._kept: dict[tuple[str, str], tuple[str, dict[str, np.ndarray]]] = {}
        self._version = 0

    @classmethod
    def create(cls, path: str | Path, fingerprint: str, study: Mapping[str, Any] | None = None) -> "Store":
        """Make a new file, whole from the first moment it is visible.

        Raises
        ------
        StoreError
            If the path exists or cannot be written.
        """
        path = Path(path)
        draft = path.with_name(f".{path.name}.{os.getpid()}")
        try:
            db = sqlite3.connect(draft, isolation_level=None)
            try:
                db.executescript(
                    f"PRAGMA application_id={APPLICATION_ID}; PRAGMA user_version={VERSION}; BEGIN; {_SCHEMA}"
                )
                db.executemany(
                    "INSERT INTO meta VALUES (?, ?)",
                    [("fingerprint", fingerprint), ("study", json.dumps(study)), ("finished", "false")],
                )
                db.execute("COMMIT")
            finally:
                db.close()
            publish(draft, path)
        except FileExistsError:
            raise StoreError(f"{path}: this file exists already; choose another name with -o.") from None
        except (sqlite3.Error, OSError) as error:
            raise StoreError(f"{path}: cannot be written ({error}); choose another place with -o.") from None
        finally:
            with suppress(OSError):
                draft.unlink()
        return cls._connect(path, write=True)

    @classmethod
    def open(cls, path: str | Path, *, write: bool = False) -> "Store":
        """Open an existing file after checking that it is ours, whole and not newer.

        Raises
        ------
        StoreError
            If it is not; the file is left untouched.
        """
        path = Path(path)
        check_header(path)
        with cls._connect(path, write=False) as reader:
            reader._check_whole()
        return cls._connect(path, write=write)

    @classmethod
    def attach(cls, path: str | Path, fingerprint: str, study: Mapping[str, Any] | None = None) -> "Store":
        """The file of this study, to write: created where there is none, else checked and opened.

        Raises
        ------
        StoreError
            If the file is refused, or belongs to another study.
        """
        if not Path(path).exists():
            return cls.create(path, fingerprint, study)
        with cls.open(path) as reader:
            reader.require(fingerprint)
        return cls._connect(Path(path), write=True)

    @classmethod
    def _connect(cls, path: Path, *, write: bool) -> "Store":
        # Reading a file without a log must not leave one beside it.
        mode = "mode=rw" if write else "mode=ro" if pending(path) else "immutable=1"
        try:
            db = sqlite3.connect(
                f"{path.absolute().as_uri()}?{mode}", uri=True, isolation_level=None, timeout=30
            )
            if write:
                db.execute("PRAGMA journal_mode=WAL")
                db.execute("PRAGMA synchronous=NORMAL")
                db.execute("PRAGMA foreign_keys=ON")
        except sqlite3.Error as error:
            raise StoreError(f"{path}: cannot be opened ({error}).") from None
        return cls(db, path)

    # -- state ---------------------------------------------------------------------------------------------

    def _meta(self, key: str) -> str:
        with self._guard():
            row = self._db.execute("SELECT value FROM meta WHERE key = ?", (key,)).fetchone()
        if row is None:
            raise damaged(self.path, f"its {key} is missing")
        return row[0]

    @property
    def fingerprint(self) -> str:
        """Digest of the study that the file belongs to."""
        return self._meta("fingerprint")

    def require(self, fingerprint: str) -> None:
        """Refuse a file that belongs to another study."""
        if self.fingerprint != fingerprint:
            raise StoreError(
                f"{self.path}: this file belongs to another study or to another command; "
                "choose another name with -o, or move the file away."
            )

    @property
    def study(self) -> dict[str, Any] | None:
        """What `create` was told of the study."""
        return json.loads(self._meta("study"))

    @property
    def finished(self) -> bool:
        """Whether the run that fills the file has ended by itself."""
        return self._meta("finished") == "true"

    @property
    def records(self) -> int:
        """Number of journal records."""
        with self._guard():
            return self._db.execute("SELECT count(*) FROM entry WHERE kind = 'journal'").fetchone()[0]

    # -- journal -------------------------------------------------------------------------------------------

    def recall(self, key: str) -> dict[str, Any] | None:
        """What was recorded under `key`: arrays and JSON values by name; None if nothing was."""
        return next((content for _, content in self.entries("journal", key)), None)

    def record(self, key: str, content: Mapping[str, Any]) -> None:
        """Keep arrays and JSON values under `key`, in one transaction."""
        with self.transaction():
            self.put("journal", key, content)

    def checkpoint(self, graph: Any) -> None:
        """Keep the graph as it stands, replacing what was kept of it before, in one transaction."""
        from contvines.graph.persistence import graph_entries

        # some numbers are worked out when they are asked for: before the write, which nothing may interrupt
        entries: Any = list(graph.entries() if hasattr(graph, "entries") else graph_entries(graph))
        with self.transaction():
            # changes when another process has written, which then may have replaced what was kept here
            version = self._db.execute("PRAGMA data_version").fetchone()[0]
            if version != self._version:
                self._kept.clear()
                self._version = version
            if not self._kept:
                self._db.execute("DELETE FROM entry WHERE kind != 'journal'")
            present = {self._renew(*entry) for entry in entries}
            for place in self._kept.keys() - present:
                self._db.execute("DELETE FROM entry WHERE kind = ? AND key = ?", place)
                del self._kept[place]
            finished = bool(graph.finished)
            self._db.execute("UPDATE meta SET value = ? WHERE key = 'finished'", (json.dumps(finished),))
            if finished:  # the journal has done its work
                self._db.execute("DELETE FROM entry WHERE kind = 'journal'")

    def _renew(self, kind: str, key: str, content: Mapping[str, Any]) -> tuple[str, str]:
        """Write an entry of the graph unless it is what was written last (arrays are not changed in place)."""
        scalars, arrays = split(content)
        known = self._kept.get((kind, key))
        if known is None or known[0] != scalars or not _same_arrays(known[1], arrays):
            self.put(kind, key, content)
            self._kept[kind, key] = (scalars, arrays)
        return kind, key

    def graph(self, *, problems: bool = True, trust: bool = False) -> Any:
        """The graph (or chart) as of the last checkpoint; without `problems`, numbers only (quicker).

        With `trust`, functions that the file names are imported; see :mod:`contvines.problems.registry`.
        """
        from contvines.graph.persistence import graph_from_entries

        kinds = ("graph", "branch", "special", "switch", "proof", "attractor", "missing")
        kinds += ("chart", "locus", "plane-point", "region")
        entries = {kind: dict(self.entries(kind)) for kind in kinds}
        try:
            if entries["chart"]:
                from contvines.loci.chart import chart_from_entries

                return chart_from_entries(entries, problems=problems, trust=trust)
            return graph_from_entries(entries, problems=problems, trust=trust)
        except OSError as error:  # a page that the graph needs
            raise StoreError(f"{self.path}: {error}.") from None
        except (AttributeError, IndexError, KeyError, OverflowError, TypeError, ValueError) as error:
            raise StoreError(
                f"{self.path}: this file does not hold a graph as contvines writes it ({error}); "
                "move it away and run again."
            ) from None

    # -- entries -------------------------------------------------------------------------------------------

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """All or nothing, whatever ends the process."""
        with HELD, self._guard():
            if self._db.in_transaction:  # an interrupt has cut one short
                self._db.execute("ROLLBACK")
            try:
                self._db.execute("BEGIN IMMEDIATE")
                yield
                self._db.execute("COMMIT")
            except BaseException:
                self._kept.clear()  # what was written last is not sure any more
                if self._db.in_transaction:
                    self._db.execute("ROLLBACK")
                raise

    def put(self, kind: str, key: str, content: Mapping[str, Any]) -> None:
        """Write one entry, replacing one of the same kind and key; call inside `transaction`."""
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
        """Entries as (key, content) in the order in which they were written, digests checked."""
        with self._guard():
            for identity, kind_, key_, scalars, digest in self._db.execute(
                "SELECT id, kind, key, scalars, digest FROM entry "
                "WHERE (?1 IS NULL OR kind = ?1) AND (?2 IS NULL OR key = ?2) ORDER BY id",
                (kind, key),
            ):
                rows = self._db.execute(
                    "SELECT name, dtype, shape, data FROM array WHERE entry = ? ORDER BY name", (identity,)
                ).fetchall()
                if digest != digest_of(kind_, key_, scalars, rows):
                    raise damaged(self.path, f"the entry {kind_} {key_!r} has changed since it was written")
                content = json.loads(scalars)
                content.update((name, unpacked(*row)) for name, *row in rows)
                yield key_, content

    def _check_whole(self) -> None:
        with self._guard():
            verdict = self._db.execute("PRAGMA quick_check(1)").fetchone()[0]
            tables = {
                row[0] for row in self._db.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
            }
        missing = {"meta", "entry", "array"} - tables
        if verdict != "ok" or missing:
            why = (
                "its pages do not fit together"
                if verdict != "ok"
                else f"it lacks the table {sorted(missing)[0]!r}"
            )
            raise damaged(self.path, why)
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
            raise damaged(self.path, "its content is broken") from None

    def settle(self) -> None:
        """Fold the log into the file, so that it stands alone, and give free pages back."""
        with self._guard():
            self._db.execute("PRAGMA journal_mode=DELETE")
            self._db.execute("VACUUM")

    def tidy(self) -> None:
        """`settle`, if nobody else uses the file now and there is room for it."""
        with suppress(sqlite3.OperationalError):
            self._db.execute("PRAGMA busy_timeout=0")
            if self._db.execute("PRAGMA journal_mode=DELETE").fetchone()[0] == "delete":
                self._db.execute("VACUUM")

    def close(self) -> None:
        """Close the file; nothing is lost if this is never called."""
        self._db.close()

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _same_arrays(one: Mapping[str, np.ndarray], other: Mapping[str, np.ndarray]) -> bool:
    return one.keys() == other.keys() and all(one[name] is other[name] for name in one)
