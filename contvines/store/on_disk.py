"""A .vines file: what it looks like, which files are refused before SQLite touches them, drafts, one run at a time, and its entries as rows.

Arrays are kept as raw bytes (float64, little-endian, unless they are complex, integer or boolean), numbers as
JSON text that round-trips exactly; every entry carries a digest of all its parts. Files of Python that entries name are looked for where they lie now.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
import struct
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path, PureWindowsPath
from typing import Any

import numpy as np

APPLICATION_ID = 0x56494E45  # "VINE"
VERSION = 1
TAILS = ("-wal", "-shm", "-journal")  # of the files that SQLite keeps beside one in use
MAGIC = b"SQLite format 3\x00"
DTYPES = {"f": "<f8", "c": "<c16", "b": "|b1", "i": "<i8", "u": "<i8"}
"""Types of arrays in a file by numpy's letter for the kind."""
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""Characters that a terminal obeys, line ends and tabs apart."""


class StoreError(ValueError):
    """A file that cannot be used; the message says why and what to do. The file is left untouched."""


def check_header(path: Path, *, reading: bool = False) -> None:
    """Refuse what is not ours before SQLite touches it; `reading` if it was to be read, not to be written."""
    other = (
        "give one that `contvines diagram` or `trace` has made"
        if reading
        else "choose another name (option -o), it is left untouched"
    )
    try:
        with path.open("rb") as file:
            head = file.read(100)
    except FileNotFoundError:
        raise StoreError(
            f"{path}: there is no such file; {other}."
            if path.suffix != ".vines"
            else f"{path}: there is no such file; `contvines diagram STUDY.toml -o {path}` makes one."
        ) from None
    except OSError as error:
        raise StoreError(f"{path}: cannot be read ({error.strerror}); {other}.") from None
    if len(head) < 100 or not head.startswith(MAGIC):
        raise StoreError(f"{path}: this is not a .vines file; {other}.")
    version, application = struct.unpack(">I", head[60:64])[0], struct.unpack(">I", head[68:72])[0]
    if application != APPLICATION_ID:
        raise StoreError(f"{path}: this is a database of another program; {other}.")
    if version > VERSION:
        raise StoreError(
            f"{path}: this file has format {version}, written by a newer contvines; this one knows format {VERSION}: "
            f"update contvines, or {'give another file' if reading else 'choose another name (option -o)'}."
        )


def cut_short(path: Path) -> bool:
    """Whether a file is shorter than its header says."""
    with path.open("rb") as file:
        head = file.read(100)
        size = os.fstat(file.fileno()).st_size
    page = struct.unpack(">H", head[16:18])[0] or 512
    page = 65536 if page == 1 else page
    return not pending(path) and (size % page != 0 or size < page * struct.unpack(">I", head[28:32])[0])


def damaged(path: Path, why: str) -> StoreError:
    """The error of a file that is damaged; the logs beside it, which SQLite would take for those of the next file, are named, too."""
    logs = [path.name + tail for tail in TAILS if path.with_name(path.name + tail).exists()]
    beside = f" and with it {' and '.join(logs)}" if logs else ""
    return StoreError(f"{path}: this file is damaged ({why}); move it away{beside}, and run again.")


def pending(path: Path) -> bool:
    """Whether a live or killed run has left a log from which SQLite completes the file."""
    log = path.with_name(path.name + "-wal")
    return log.exists() and log.stat().st_size > 0


_number = count()


def draft_of(path: Path) -> Path:
    """A name beside a file for its draft."""
    return path.with_name(f".{path.name}.{os.getpid()}-{next(_number)}.draft")


def remove_drafts(path: Path) -> None:
    """Remove the drafts of a file that killed processes have left."""
    name = re.compile(rf"\.+{re.escape(path.name)}\.(\d+)-\d+\.draft.*")  # with drafts and logs of their own
    for file in path.parent.iterdir():
        found = name.fullmatch(file.name)
        if found and not _alive(int(found[1])):
            with suppress(OSError):
                file.unlink()


def _alive(process: int) -> bool:
    if os.name == "nt":  # where signal 0 is not only a question
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        pass
    return True


def publish(draft: Path, path: Path) -> None:
    """Give a whole file its name; fails, rather than clobbers, if someone else was first.

    The log that a killed run has left, of a file that is gone, must not be taken for that of the new one.
    """
    if path.exists():
        raise FileExistsError
    orphans = [(path.with_name(path.name + tail), draft.with_name(draft.name + tail)) for tail in TAILS]
    orphans = [(log, aside) for log, aside in orphans if _renamed(log, aside)]
    try:
        try:
            os.link(draft, path)
        except FileExistsError:
            raise
        except OSError:  # a file system without links
            if path.exists():
                raise FileExistsError from None
            os.rename(draft, path)
    except BaseException:
        for log, aside in orphans:  # they belong to the file of who was first
            _renamed(aside, log)
        raise
    for _, aside in orphans:
        with suppress(OSError):
            aside.unlink()


def _renamed(old: Path, new: Path) -> bool:
    try:
        os.rename(old, new)
    except OSError:
        return False
    return True


@contextmanager
def locked(path: Path, wait: Callable[[], None]) -> Iterator[None]:
    """Hold the lock of a file.

    The lock is a file `.NAME.lock` beside it. The operating system gives the lock back when the process ends, however it ends;
    the file is removed with the lock, or by the next run. Where no such file can be made, there is no lock.

    Parameters
    ----------
    path : Path
    wait : callable
        Called once if another process holds the lock.
    """
    place = path.with_name(f".{path.name}.lock")
    try:
        handle = _taken(place, wait)
    except OSError:  # nothing can be written here: the run itself says so
        yield
        return
    try:
        yield
    finally:
        with suppress(OSError):
            place.unlink()
        os.close(handle)
        if sys.platform == "win32":  # where no open file can be removed
            with suppress(OSError):
                place.unlink()


def _taken(place: Path, wait: Callable[[], None]) -> int:
    """An open handle of the lock file, with the lock; of the file that still has the name."""
    while True:
        handle = os.open(place, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            if not _try(handle):
                wait()
                wait = _silent
                _take(handle)
            if os.path.samestat(os.fstat(handle), os.stat(place)):
                return handle
        except FileNotFoundError:  # who had the lock has removed its file meanwhile
            pass
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)


def _silent() -> None:
    """Nothing: it has been said that this run waits."""


if sys.platform == "win32":
    import msvcrt

    def _try(handle: int) -> bool:
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

    def _take(handle: int) -> None:
        while True:
            with suppress(OSError):  # after ten seconds
                return msvcrt.locking(handle, msvcrt.LK_LOCK, 1)

else:
    import fcntl

    # locks of the process: copies of it, such as the workers of a survey, do not inherit them
    def _try(handle: int) -> bool:
        try:
            fcntl.lockf(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError):
            return False
        return True

    def _take(handle: int) -> None:
        fcntl.lockf(handle, fcntl.LOCK_EX)


def set_aside(path: Path, *others: Path) -> Path | None:
    """Rename a file to `NAME.old.EXT` (or `.old2.`, where that name is taken), and the files that belong to it likewise.

    Parameters
    ----------
    path : Path
    *others : Path
        Files in the same folder whose names begin as that of the file does.

    Returns
    -------
    Path or None
        The new name of the file; None if there was nothing to rename.
    """
    files = [file for file in (*others, path) if file.is_file()]
    if not files:
        return None
    number = 1
    while True:
        stem = f"{path.stem}.old{number if number > 1 else ''}"
        named = {file: file.with_name(stem + file.name.removeprefix(path.stem)) for file in files}
        if not any(new.exists() for new in named.values()):
            break
        number += 1
    for file, new in named.items():
        file.rename(new)
    return path.with_name(stem + path.suffix)


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
