"""The rows of an unfinished survey on disk: a survey that is killed goes on from them.

A line is a JSON text with a checksum before it; from the first damaged line on, rows are worked out again.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

from .work import Row


class Rows:
    """The rows that are there, each kept as soon as it is.

    Parameters
    ----------
    path : Path or None
        Where; None keeps nothing.
    header : mapping
        What decides the rows: those of another survey are not taken over.
    """

    def __init__(self, path: Path | None, header: Mapping[str, Any]) -> None:
        self.path, self.header = path, dict(header)
        self.found: dict[int, Row] = {}
        self.file: IO[str] | None = None

    def __enter__(self) -> Rows:
        if self.path is None:
            return self
        complete = self._read()
        self.file = self.path.open("r+b" if complete else "wb")  # type: ignore[assignment]
        assert self.file is not None
        self.file.seek(complete)
        self.file.truncate()
        if not complete:
            self._line(self.header)
        return self

    def keep(self, row: Row) -> None:
        """One more row."""
        self.found[row.index] = row
        if self.file is not None:
            self._line(vars(row))

    def finish(self) -> None:
        """The survey is complete and kept elsewhere."""
        if self.path is not None:
            self.__exit__()
            self.path.unlink(missing_ok=True)

    def __exit__(self, *_: object) -> None:
        if self.file is not None:
            self.file.close()
            self.file = None

    def _line(self, data: Mapping[str, Any]) -> None:
        assert self.file is not None
        self.file.write(_line(data) + b"\n")  # type: ignore[arg-type]
        self.file.flush()

    def _read(self) -> int:
        """Take over the rows of the same survey; the length in bytes of what is whole."""
        assert self.path is not None
        if not self.path.is_file():
            return 0
        length = 0
        lines = self.path.read_bytes().split(b"\n")
        try:
            if lines[0] != _line(self.header):
                return 0
            length = len(lines[0]) + 1
            for line in lines[1:-1]:
                row = Row(**json.loads(_checked(line)))
                self.found[row.index] = row
                length += len(line) + 1
        except (ValueError, TypeError, RecursionError):
            pass  # a line that a kill cut short
        return length if len(lines) > 1 else 0


def _line(data: Mapping[str, Any]) -> bytes:
    text = json.dumps(data).encode()
    return b"%08x %s" % (zlib.crc32(text), text)


def _checked(line: bytes) -> bytes:
    """The JSON text of a line.

    Raises
    ------
    ValueError
        If its checksum is another.
    """
    kept, _, text = line.partition(b" ")
    if int(kept, 16) != zlib.crc32(text):
        raise ValueError("a damaged line")
    return text
