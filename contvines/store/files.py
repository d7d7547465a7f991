"""A graph to a file of its own, and back."""

import os
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..continuation.hints import hinting
from .database import Store
from .header import TAILS, check_header
from .publishing import draft_of


@hinting
def save(graph: Any, path: str | Path, fingerprint: str | None = None) -> None:
    """Write a graph to a file of its own; an existing .vines file is replaced in one step.

    Raises
    ------
    StoreError
        If the path holds a file that is not ours (it is left untouched), or cannot be written.
    """
    path = Path(path)
    if path.exists():
        check_header(path)
    draft = draft_of(path)
    try:
        with Store.create(draft, fingerprint or "saved from Python", getattr(graph, "model", None)) as store:
            store.checkpoint(graph)
            store.settle()
        for tail in TAILS:
            with suppress(OSError):
                path.with_name(path.name + tail).unlink()
        os.replace(draft, path)
    finally:
        with suppress(OSError):
            draft.unlink()


@hinting
def resume(path: str | Path, fingerprint: str = "run from Python") -> Store:
    """The journal kept in a file, made where there is none: `diagram(..., journal=resume("run.vines"))`.

    Run the same command with the same journal again after an interruption, and it goes on where it stopped.
    `fingerprint` names the run; a file of another one is refused.

    Raises
    ------
    StoreError
        If the file is not ours, is damaged, is newer or belongs to another run.
    """
    return Store.attach(path, fingerprint)


@hinting
def load(path: str | Path, *, problems: bool = True, trust: bool = False) -> Any:
    """The graph kept in a .vines file; `graph.finished` says whether its run had ended.

    A file is data: loading one runs nothing that it names.

    Parameters
    ----------
    path : path of the file.
    problems : bool
        Rebuild the problems of the branches, so that orbits and measures can be had (else numbers only).
    trust : bool
        Import functions of your own that the file names, those of an :class:`~contvines.AlgebraicProblem` say. Without it
        they are found only if this program has made a problem from them before. Importing runs code: only for files whose
        maker you trust.

    Raises
    ------
    StoreError
        If the file is not ours, is damaged or is newer.
    """
    check_header(Path(path), reading=True)
    with Store.open(path) as store:
        return store.graph(problems=problems, trust=trust)
