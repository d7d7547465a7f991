"""A .vines file from outside: what it looks like, which files are refused before SQLite touches them, drafts, and one run at a time."""

from __future__ import annotations

import os
import re
import struct
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path

APPLICATION_ID = 0x56494E45  # "VINE"
VERSION = 1
TAILS = ("-wal", "-shm", "-journal")  # of the files that SQLite keeps beside one in use
MAGIC = b"SQLite format 3\x00"


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
