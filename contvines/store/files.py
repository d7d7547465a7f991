"""Save graphs and charts to .vines files, load them, and resume interrupted computations."""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar, overload

from ..continuation.settings import hinting
from ..journal import Resumable
from .database import Store
from .on_disk import TAILS, check_header, draft_of

if TYPE_CHECKING:
    from ..bifurcation.kind import Kind
    from ..graph import Graph
    from ..loci.chart import Chart

Result = TypeVar("Result", bound=Resumable)

FROM_PYTHON = "saved from Python"  # fingerprint of files that no study or run made


@hinting
def save(graph: Graph | Chart, path: str | Path, fingerprint: str | None = None) -> None:
    """Write a graph or chart to a .vines file; an existing .vines file is replaced atomically.

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
        If the path is a file of another kind (it is left untouched), or cannot be written.
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
    """Resume an interrupted computation: `resume(graph)`, or `diagram(..., journal=resume("run.vines"))`.

    Parameters
    ----------
    path : Graph, Chart, Survey or path
        Either the partial result of an interrupted call (the ``graph`` of :class:`contvines.Interrupted`), or a .vines file, which is
        made if it does not exist.
    fingerprint : str
        Name of the run that a file belongs to.

    Returns
    -------
    Graph, Chart, Survey or Store
        For a partial result: the complete result, after the computation has continued. For a file: its journal; the same call with
        this journal continues where it stopped.

    Raises
    ------
    ValueError
        If the result was not interrupted in this program.
    StoreError
        If the file is no .vines file, is damaged or newer, or belongs to another run.
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
def load(
    path: str | Path, *, problems: bool = True, trust: bool = False, kinds: Iterable[Kind] = ()
) -> Graph | Chart:
    """Load the graph or chart from a .vines file; `finished` of the result tells whether its run had ended.

    Without `trust`, loading a file executes no code that the file names.

    Parameters
    ----------
    path : path of the file
    problems : bool
        Rebuild the problems of the branches, which orbits and measures need; False: numbers only.
    trust : bool
        Import user functions that the file names, for example those of an :class:`~contvines.AlgebraicProblem`. Without it they are
        available only if this program has already made a problem from them. Importing executes code: use it only for files whose
        author you trust.
    kinds : iterable of Kind
        Kinds of special points of your own, as given to `diagram`: files do not keep their functions, and the loci of a chart need them.

    Returns
    -------
    Graph or Chart

    Raises
    ------
    StoreError
        If the file is no .vines file, is damaged or newer.
    """
    check_header(Path(path), reading=True)
    with Store.open(path) as store:
        return store.graph(problems=problems, trust=trust, kinds=kinds)
