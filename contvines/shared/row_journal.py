"""Journal of the rows of an unfinished sweep or survey on disk, from which a killed run resumes.

Each line is a checksum and a JSON text; rows from the first damaged line on are computed again.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO, Any, Generic, TypeVar

R = TypeVar("R")


class Rows(Generic[R]):
    """Rows computed so far, `found`, each written to disk at once. Use it as a context manager.

    Parameters
    ----------
    path : Path or None
        Of the journal; None: nothing is stored on disk.
    header : mapping
        Everything that determines the rows; rows under another header are not reused.
    kind : type
        Class of the rows; called with the attributes by name, which must be JSON-able.
    """

    def __init__(self, path: Path | None, header: Mapping[str, Any], kind: Callable[..., R]) -> None:
        self.path, self.header, self.kind = path, dict(header), kind
        self.found: list[R] = []
        self.file: IO[bytes] | None = None

    def __enter__(self) -> Rows[R]:
        if self.path is not None:
            complete = self._read(self.path)
            self.file = self.path.open("r+b" if complete else "wb")
            self.file.seek(complete)
            self.file.truncate()
            if not complete:
                self._line(self.header)
        return self

    def keep(self, row: R) -> None:
        """Add a row and write it to disk."""
        self.found.append(row)
        self._line(vars(row))

    def finish(self) -> None:
        """Delete the journal, once the run is complete and its result stored elsewhere."""
        self.__exit__()
        if self.path is not None:
            self.path.unlink(missing_ok=True)

    def __exit__(self, *_: object) -> None:
        if self.file is not None:
            self.file.close()
            self.file = None

    def _line(self, data: Mapping[str, Any]) -> None:
        if self.file is not None:
            text = json.dumps(data).encode()
            self.file.write(b"%08x %s\n" % (zlib.crc32(text), text))
            self.file.flush()

    def _read(self, path: Path) -> int:
        """Read the rows of a journal with the same header; return the length in bytes of its undamaged part."""
        length = 0
        if path.is_file():
            self.found = []
            first, *lines = path.read_bytes().split(b"\n")
            try:
                if _data(first) == self.header and lines:
                    length = len(first) + 1
                    for line in lines[:-1]:
                        self.found.append(self.kind(**_data(line)))
                        length += len(line) + 1
            except (ValueError, TypeError, RecursionError):
                pass  # a line cut short by a kill
        return length


def rows_of_another(path: Path, header: Mapping[str, Any]) -> int:
    """Return the number of rows in a journal of another run of the same kind; 0 for any other file.

    Parameters
    ----------
    path : Path
    header : mapping
        Of this run; its entry ``contvines`` is the kind of run.
    """
    try:
        first, *rows = path.read_bytes().split(b"\n")
        found = _data(first)
    except (OSError, ValueError, RecursionError):
        return 0
    same_kind = isinstance(found, dict) and found.get("contvines") == header["contvines"]
    return len(rows) - 1 if same_kind and found != header else 0


def _data(line: bytes) -> Any:
    """Return the data of a line; lines without checksum are from early versions.

    Raises
    ------
    ValueError
        If the checksum is wrong.
    """
    checksum, _, text = line.partition(b" ")
    if line.startswith(b"{"):
        text = line
    elif int(checksum, 16) != zlib.crc32(text):
        raise ValueError("a damaged line")
    return json.loads(text)
