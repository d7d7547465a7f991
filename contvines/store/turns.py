"""One run at a time on a file: the next one waits until the last one has ended, by itself or killed."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


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
