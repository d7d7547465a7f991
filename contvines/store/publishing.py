"""A finished draft gets the name of a file that does not exist yet."""

import os
from contextlib import suppress
from pathlib import Path

from .header import TAILS


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
