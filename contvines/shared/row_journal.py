"""The rows of an unfinished sweep or survey on disk: one that is killed goes on from them.

A line is a JSON text with a checksum before it; from the first damaged line on, rows are worked out again.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO, Any, Generic, TypeVar

R = TypeVar("R")


class Rows(Generic[R]):
    """The rows that are there, each kept as soon as it is.

    Parameters
    ----------
    path : Path or None
        Where; None keeps nothing.
    header : mapping
        What decides the rows: those of another run are not taken over.
    kind : type
        Makes a row of its attributes by name, which JSON has.
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
        """One more row."""
        self.found.append(row)
        self._line(vars(row))

    def finish(self) -> None:
        """The run is complete and kept elsewhere."""
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
        """Take over the rows of the same run; the length in bytes of what is whole."""
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
                pass  # a line that a kill cut short
        return length


def rows_of_another(path: Path, header: Mapping[str, Any]) -> int:
    """How many rows of another run of the same kind a file holds.

    Parameters
    ----------
    path : Path
    header : mapping
        Of this run; the kind is its entry ``contvines``.
    """
    try:
        first, *rows = path.read_bytes().split(b"\n")
        found = _data(first)
    except (OSError, ValueError, RecursionError):
        return 0
    ours = isinstance(found, dict) and found.get("contvines") == header["contvines"]
    return len(rows) - 1 if ours and found != header else 0


def _data(line: bytes) -> Any:
    """What a line says; those of sweeps had no checksum once.

    Raises
    ------
    ValueError
        If its checksum is another.
    """
    kept, _, text = line.partition(b" ")
    if line.startswith(b"{"):
        text = line
    elif int(kept, 16) != zlib.crc32(text):
        raise ValueError("a damaged line")
    return json.loads(text)
