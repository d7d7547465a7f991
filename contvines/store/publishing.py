"""A finished draft gets the name of a file that does not exist yet."""

import os
import re
from contextlib import suppress
from itertools import count
from pathlib import Path

from .header import TAILS

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
