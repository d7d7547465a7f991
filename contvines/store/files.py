"""A graph to a file of its own, and back."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar, overload

from ..continuation.settings import hinting
from ..journal import Resumable
from .database import Store
from .on_disk import TAILS, check_header, draft_of

if TYPE_CHECKING:
    from ..graph import Graph
    from ..loci.chart import Chart

Result = TypeVar("Result", bound=Resumable)

FROM_PYTHON = "saved from Python"  # instead of the name of a run


@hinting
def save(graph: Graph | Chart, path: str | Path, fingerprint: str | None = None) -> None:
    """Write a graph to a file of its own; an existing .vines file is replaced in one step.

    Parameters
    ----------
    graph : Graph or Chart
    path : path of the file
        Its name ends in .vines.
    fingerprint : str, optional
        Name of the run, which `resume` compares.

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
        with Store.create(draft, fingerprint or FROM_PYTHON, graph.model) as store:
            store.checkpoint(graph)
            store.settle()
        for tail in TAILS:
            with suppress(OSError):
                path.with_name(path.name + tail).unlink()
        os.replace(draft, path)
    finally:
        with suppress(OSError):
            draft.unlink()


@overload
def resume(path: Result, fingerprint: str = ...) -> Result: ...


@overload
def resume(path: str | Path, fingerprint: str = ...) -> Store: ...


@hinting
def resume(path: Resumable | str | Path, fingerprint: str = "run from Python") -> object:
    """Go on with what was interrupted: `resume(graph)`, or `diagram(..., journal=resume("run.vines"))`.

    Parameters
    ----------
    path : Graph, Chart, Survey or path
        What an interrupted call has left (the ``graph`` of :class:`contvines.Interrupted`): the work goes on, and the whole result is
        returned. Or a .vines file, made where there is none: its journal is returned; the same call with the same
        journal goes on where it stopped.
    fingerprint : str
        Name of the run of a file; a file of another run is refused.

    Raises
    ------
    ValueError
        If the result was not interrupted in this program.
    StoreError
        If the file is not ours, is damaged, is newer or belongs to another run.
    """
    if isinstance(path, Resumable):
        if path.rest is None:
            raise ValueError(
                f"{path!r} was not interrupted in this program, so there is nothing to go on with; "
                'of a file, run the same call again with journal=contvines.resume("FILE.vines")'
            )
        return path.rest()
    return Store.attach(path, fingerprint)


@hinting
def load(path: str | Path, *, problems: bool = True, trust: bool = False) -> Graph | Chart:
    """The graph kept in a .vines file; `graph.finished` says whether its run had ended.

    A file is data: loading one runs nothing that it names.

    Parameters
    ----------
    path : path of the file.
    problems : bool
        Rebuild the problems of the branches, so that orbits and measures can be obtained (else numbers only).
    trust : bool
        Import functions of your own that the file names, those of an :class:`~contvines.AlgebraicProblem` say. Without it
        they are found only if this program has made a problem from them before. Importing runs code: only for files whose
        maker you trust.

    Returns
    -------
    Graph or Chart

    Raises
    ------
    StoreError
        If the file is not ours, is damaged or is newer.
    """
    check_header(Path(path), reading=True)
    with Store.open(path) as store:
        return store.graph(problems=problems, trust=trust)
