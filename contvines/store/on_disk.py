"""The format of .vines files: checks before SQLite opens a file, drafts, locks, and the conversion of entries to rows.

Arrays are stored as raw bytes (float64, little-endian, unless they are complex, integer or boolean), numbers as JSON text that
round-trips exactly; every entry has a digest of all its parts. Python files that entries name may have been moved; they are searched
for by `found_again`.
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
TAILS = ("-wal", "-shm", "-journal")  # endings of the files that SQLite has beside a database in use
MAGIC = b"SQLite format 3\x00"
DTYPES = {"f": "<f8", "c": "<c16", "b": "|b1", "i": "<i8", "u": "<i8"}
"""Stored type of an array by its numpy kind (``dtype.kind``); other kinds are stored as float64."""
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""Control characters that a terminal interprets, without line ends and tabs."""


class StoreError(ValueError):
    """A file that cannot be used; the message says why and what to do. The file is left untouched."""


def check_header(path: Path, *, reading: bool = False) -> None:
    """Check the header of a file before SQLite opens it.

    Parameters
    ----------
    path : Path
    reading : bool
        Whether the file is to be read, not written: it changes the advice in the message.

    Raises
    ------
    StoreError
        If there is no such file, it is no .vines file, or its format is newer.
    """
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
    """Whether a file is shorter than its header states."""
    with path.open("rb") as file:
        head = file.read(100)
        size = os.fstat(file.fileno()).st_size
    page = struct.unpack(">H", head[16:18])[0] or 512
    page = 65536 if page == 1 else page
    return not pending(path) and (size % page != 0 or size < page * struct.unpack(">I", head[28:32])[0])


def damaged(path: Path, reason: str) -> StoreError:
    """Return the error for a damaged file; it also names the logs beside it, which SQLite would apply to a new file of the same name."""
    logs = [path.name + tail for tail in TAILS if path.with_name(path.name + tail).exists()]
    logs_text = f" and with it {' and '.join(logs)}" if logs else ""
    return StoreError(f"{path}: this file is damaged ({reason}); move it away{logs_text}, and run again.")


def pending(path: Path) -> bool:
    """Whether a live or killed run has left a log from which SQLite completes the file."""
    log = path.with_name(path.name + "-wal")
    return log.exists() and log.stat().st_size > 0


_number = count()


def draft_of(path: Path) -> Path:
    """Return an unused path for the draft of a file, in the same folder."""
    return path.with_name(f".{path.name}.{os.getpid()}-{next(_number)}.draft")


def remove_drafts(path: Path) -> None:
    """Remove the drafts of a file that killed processes have left behind."""
    name = re.compile(rf"\.+{re.escape(path.name)}\.(\d+)-\d+\.draft.*")  # with drafts and logs of their own
    for file in path.parent.iterdir():
        found = name.fullmatch(file.name)
        if found and not _alive(int(found[1])):
            with suppress(OSError):
                file.unlink()


def _alive(process: int) -> bool:
    if os.name == "nt":  # on Windows, os.kill with signal 0 would end the process
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        pass
    return True


def publish(draft: Path, path: Path) -> None:
    """Move a complete draft to its final path.

    Logs at the final path that a killed run has left of a deleted file are removed: SQLite would apply them to the new file.

    Raises
    ------
    FileExistsError
        If the path exists; an existing file is never replaced.
    """
    if path.exists():
        raise FileExistsError
    orphans = [(path.with_name(path.name + tail), draft.with_name(draft.name + tail)) for tail in TAILS]
    orphans = [(log, backup) for log, backup in orphans if _renamed(log, backup)]
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
        for log, backup in orphans:  # they may belong to the file that another process has made
            _renamed(backup, log)
        raise
    for _, backup in orphans:
        with suppress(OSError):
            backup.unlink()


def _renamed(old: Path, new: Path) -> bool:
    try:
        os.rename(old, new)
    except OSError:
        return False
    return True


@contextmanager
def locked(path: Path, wait: Callable[[], None]) -> Iterator[None]:
    """Hold the lock of a file, as a context manager; wait while another process holds it.

    The lock is on a file `.NAME.lock` in the same folder. The operating system releases it when the process ends in any way;
    the lock file is removed on release, or by the next run. If no lock file can be made, there is no lock.

    Parameters
    ----------
    path : Path
    wait : callable
        Called once if another process holds the lock.
    """
    place = path.with_name(f".{path.name}.lock")
    try:
        handle = _locked(place, wait)
    except OSError:  # nothing can be written here: the run itself will report it
        yield
        return
    try:
        yield
    finally:
        with suppress(OSError):
            place.unlink()
        os.close(handle)
        if sys.platform == "win32":  # Windows cannot remove an open file
            with suppress(OSError):
                place.unlink()


def _locked(place: Path, wait: Callable[[], None]) -> int:
    """Return an open handle of the lock file, locked; it is certain that the file still has this name."""
    while True:
        handle = os.open(place, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            if not _try(handle):
                wait()
                wait = _silent
                _take(handle)
            if os.path.samestat(os.fstat(handle), os.stat(place)):
                return handle
        except FileNotFoundError:  # the process with the lock has removed the lock file meanwhile: try again
            pass
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)


def _silent() -> None:
    """Do nothing: `wait` has been called already."""


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
            with suppress(OSError):  # raised after ten seconds: try again
                return msvcrt.locking(handle, msvcrt.LK_LOCK, 1)

else:
    import fcntl

    # these locks belong to the process: forked copies of it, for example workers of a survey, do not inherit them
    def _try(handle: int) -> bool:
        try:
            fcntl.lockf(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError):
            return False
        return True

    def _take(handle: int) -> None:
        fcntl.lockf(handle, fcntl.LOCK_EX)


def set_aside(path: Path, *others: Path) -> Path | None:
    """Rename a file to `NAME.old.EXT` (or `.old2.` and so on if that name exists), and the files that belong to it likewise.

    Parameters
    ----------
    path : Path
    *others : Path
        Files in the same folder whose names begin with the file's stem.

    Returns
    -------
    Path or None
        The new path of the file; None if no file exists.
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
    """Split an entry's content into the JSON text of everything but the arrays, and the arrays."""
    arrays = {k: v for k, v in content.items() if isinstance(v, np.ndarray)}
    return json.dumps({k: v for k, v in content.items() if k not in arrays}, default=_plain), arrays


def _plain(value: object) -> object:
    """Convert numpy scalars and mappings to values that JSON can hold."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{type(value).__name__} cannot be kept in a file")


def packed(array: np.ndarray) -> tuple[str, str, bytes]:
    dtype = DTYPES.get(array.dtype.kind, DTYPES["f"])
    return dtype, json.dumps(array.shape), np.ascontiguousarray(array, dtype=dtype).tobytes()


def unpacked(dtype: str, shape: str, data: bytes) -> np.ndarray:
    """Return the array of which `packed` made type, shape and bytes.

    Raises
    ------
    ValueError
        If they do not fit together.
    """
    sizes = json.loads(shape)
    if dtype not in DTYPES.values() or not isinstance(sizes, list) or any(type(n) is not int for n in sizes):
        raise ValueError(f"an array of type {dtype!r} and shape {shape!r}")
    if min(sizes, default=0) < 0 or math.prod(sizes) * np.dtype(dtype).itemsize != len(data):
        raise ValueError(f"an array of shape {shape!r} in {len(data)} bytes")
    return np.frombuffer(data, dtype=dtype).reshape(sizes).copy()


def printable(content: Mapping[str, Any]) -> dict[str, Any]:
    """Escape the control characters in all texts of a file's content (as \\x1b), so that it can be printed safely on a terminal."""
    return {printable_text(name): _printable(part) for name, part in content.items()}


def printable_text(text: str) -> str:
    """Escape the control characters in a text."""
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
    """Replace the paths of Python files (machine files, files of equations) that no longer exist by paths at which the files are found.

    A file is searched for in some folders by the end of its path: the file's name, then with its folder (``machines/press.py``), and so
    on. The caller must check that the text of the file is the one that was used.

    Parameters
    ----------
    content : mapping
        Of an entry.
    folders : iterable of Path
        The folder of the result, and that of its study.
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
