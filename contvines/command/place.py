"""The place of a result: one run at a time is at work on it, and a fresh start sets aside the file that is there."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from contvines.command.compose import say


@contextmanager
def held(target: Path, quiet: bool, fresh: bool = False, others: tuple[Path, ...] = ()) -> Iterator[None]:
    """Be the only run at work on a file; wait for another one first. What killed runs have left beside it is removed.

    Parameters
    ----------
    target : Path
        A .vines file, or another one that a run writes piece by piece.
    quiet : bool
    fresh : bool
        Set aside the file that is there.
    others : tuple of Path
        Files that belong to the target, and are set aside with it.

    Raises
    ------
    ValueError
        If a file cannot be set aside.
    """
    from contvines.store.publishing import remove_drafts
    from contvines.store.turns import locked

    if not target.parent.is_dir() or (target.exists() and not target.is_file()):  # a pipe, or a terminal
        yield
        return
    with locked(target, lambda: say(f"another run is at work on {target}: waiting until it ends.", quiet)):
        remove_drafts(target)
        if fresh:
            _set_aside(target, others, quiet)
        yield
        if any(log.exists() for log in _logs(target)):
            _fold(target)


def _set_aside(target: Path, others: tuple[Path, ...], quiet: bool) -> None:
    from contvines.store.turns import set_aside

    _fold(target)
    try:
        aside = set_aside(target, *others, *_logs(target))
    except OSError as error:
        raise ValueError(
            f"{target}: cannot be set aside ({error.strerror}); choose another name with -o."
        ) from None
    if aside is not None:
        say(f"{target} is set aside as {aside}", quiet)


def _logs(target: Path) -> list[Path]:
    from contvines.store.header import TAILS

    return [target.with_name(target.name + tail) for tail in TAILS]


def _fold(target: Path) -> None:
    """Fold its log into a .vines file, unless that is damaged."""
    from contvines.store import Store, StoreError

    if target.suffix == ".vines" and target.exists():
        with suppress(StoreError), Store.open(target, write=True) as store:
            store.tidy()
