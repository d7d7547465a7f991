"""Arrays and JSON values as the rows of an entry, and back; files of Python that they name, where they lie now.

Arrays are kept as raw bytes (float64, little-endian, unless they are complex, integer or boolean), numbers as
JSON text that round-trips exactly; every entry carries a digest of all its parts.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Iterable, Mapping
from pathlib import Path, PureWindowsPath
from typing import Any

import numpy as np

DTYPES = {"f": "<f8", "c": "<c16", "b": "|b1", "i": "<i8", "u": "<i8"}
"""Types of arrays in a file by numpy's letter for the kind."""


def split(content: Mapping[str, Any]) -> tuple[str, dict[str, np.ndarray]]:
    """JSON text of everything but the arrays, and the arrays."""
    arrays = {k: v for k, v in content.items() if isinstance(v, np.ndarray)}
    return json.dumps({k: v for k, v in content.items() if k not in arrays}, default=_plain), arrays


def _plain(value: object) -> object:
    """A value that JSON can hold, for numpy's scalars and foreign mappings."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{type(value).__name__} cannot be kept in a file")


def packed(array: np.ndarray) -> tuple[str, str, bytes]:
    dtype = DTYPES.get(array.dtype.kind, DTYPES["f"])
    return dtype, json.dumps(array.shape), np.ascontiguousarray(array, dtype=dtype).tobytes()


def unpacked(dtype: str, shape: str, data: bytes) -> np.ndarray:
    """The array that `packed` took apart.

    Raises
    ------
    ValueError
        If it cannot be one of `packed`.
    """
    sizes = json.loads(shape)
    if dtype not in DTYPES.values() or not isinstance(sizes, list) or any(type(n) is not int for n in sizes):
        raise ValueError(f"an array of type {dtype!r} and shape {shape!r}")
    if min(sizes, default=0) < 0 or math.prod(sizes) * np.dtype(dtype).itemsize != len(data):
        raise ValueError(f"an array of shape {shape!r} in {len(data)} bytes")
    return np.frombuffer(data, dtype=dtype).reshape(sizes).copy()


CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""Characters that a terminal obeys, line ends and tabs apart."""


def printable(content: Mapping[str, Any]) -> dict[str, Any]:
    """Values by name whose texts show control characters (as \\x1b): what a file says is printed on terminals."""
    return {printable_text(name): _printable(part) for name, part in content.items()}


def printable_text(text: str) -> str:
    """A text that shows control characters."""
    return CONTROL.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


def _printable(value: object) -> object:
    if isinstance(value, str):
        return printable_text(value)
    if isinstance(value, dict):
        return {_printable(key): _printable(part) for key, part in value.items()}
    return [_printable(part) for part in value] if isinstance(value, list) else value


def digest_of(kind: str, key: str, scalars: str, rows: list[tuple[str, str, str, bytes]]) -> bytes:
    digest = hashlib.blake2b(digest_size=16)
    for part in (kind, key, scalars, *(p for row in rows for p in row)):
        part = part if isinstance(part, bytes) else part.encode()
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.digest()


def found_again(content: Mapping[str, Any], folders: Iterable[Path]) -> dict[str, Any]:
    """Contents of a file, with the places of machine files and of files of equations that are gone replaced by those in which they are found.

    A file is looked for in some folders by the end of its path: ``machines/press.py``, then the longer ends. Whether its text is the one that
    was used is judged by whoever runs it.

    Parameters
    ----------
    content : mapping
    folders : iterable of Path
        That of the result, and that of its study.
    """
    places: dict[str, str] = {}
    return {name: _placed(value, list(folders), places) for name, value in content.items()}


def _placed(value: object, folders: list[Path], places: dict[str, str]) -> object:
    if isinstance(value, str) and value.endswith(".py"):
        if value not in places:
            places[value] = _place(value, folders)
        return places[value]
    if isinstance(value, Mapping):
        return {name: _placed(part, folders, places) for name, part in value.items()}
    return [_placed(part, folders, places) for part in value] if isinstance(value, list) else value


def _place(path: str, folders: list[Path]) -> str:
    parts = PureWindowsPath(path).parts  # either kind of slash
    if len(parts) < 2 or "\n" in path or Path(path).exists():
        return path
    for taken in range(1, len(parts)):
        for folder in folders:
            place = folder.joinpath(*parts[-taken:])
            if place.is_file():
                return str(place)
    return path
