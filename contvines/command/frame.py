"""Steps common to all commands: the path of the result, progress, Ctrl-C, printing and drawing of the result."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import typer

from ..shared.files import refuse_ending, refuse_place
from ..text_table import fitted
from .options import MANY

if TYPE_CHECKING:
    from ..graph import Graph
    from ..loci.chart import Chart

MOST_NAMED = 24  # largest number of labels in one message


class Interrupted(Exception):
    """Ctrl-C during the computation; the message says what is stored and how to continue."""


def say(text: str, quiet: bool = False) -> None:
    """Print a remark for the user on stderr, so that stdout has results only."""
    if not quiet:
        print(fitted(text), file=sys.stderr)


# ---------------------------------------------------------------------- places
def beside(path: Path, ending: str) -> Path:
    """Return the default path of a result: the name of the study or file with another ending, in the current folder."""
    return Path(path.stem + ending)


def place_of(output: Path | None, source: Path, ending: str) -> Path:
    """Return the path of a result, and check before any work that it can be written there.

    Parameters
    ----------
    output : Path or None
        Given by the user; None: the default, see `beside`.
    source : Path
        The study or file from which the result is computed; it must not be the same.
    ending : str
        Of the result's name.

    Raises
    ------
    ValueError
        If the path is invalid.
    """
    path, kind = output or beside(source, ending), ending.rpartition(".")[2]
    if path.resolve() == source.resolve():
        noun = "the study" if source.suffix == ".toml" else "the file"
        raise ValueError(f"{path}: this is {noun} itself; choose another name with -o.")
    if kind == "vines":
        refuse_place(path)
        refuse_ending(path, kind)
    else:
        from ..export import check_target

        check_target(path, kind)
    return path


@contextmanager
def held(target: Path, quiet: bool, fresh: bool = False, others: tuple[Path, ...] = ()) -> Iterator[None]:
    """Hold the lock of a result's file, after waiting for other runs on it; drafts that killed runs have left are removed.

    Parameters
    ----------
    target : Path
        A .vines file, or another file that a run writes piece by piece.
    quiet : bool
    fresh : bool
        Rename an existing file first; see `contvines.store.on_disk.set_aside`.
    others : tuple of Path
        Files that belong to the target and are renamed with it.

    Raises
    ------
    ValueError
        If a file cannot be renamed.
    """
    from ..store.on_disk import TAILS, locked, remove_drafts, set_aside

    if not target.parent.is_dir() or (target.exists() and not target.is_file()):  # a pipe, or a terminal
        yield
        return
    logs = [target.with_name(target.name + tail) for tail in TAILS]
    with locked(target, lambda: say(f"another run is at work on {target}: waiting until it ends.", quiet)):
        remove_drafts(target)
        if fresh:
            _fold(target)
            try:
                backup = set_aside(target, *others, *logs)
            except OSError as error:
                raise ValueError(
                    f"{target}: cannot be set aside ({error.strerror}); choose another name with -o."
                ) from None
            if backup is not None:
                say(f"{target} is set aside as {backup}", quiet)
        yield
        if any(log.exists() for log in logs):
            _fold(target)


def _fold(target: Path) -> None:
    """Merge the write-ahead log of a .vines file into it, unless the file is damaged."""
    from ..store import Store, StoreError

    if target.suffix == ".vines" and target.exists():
        with suppress(StoreError), Store.open(target, write=True) as store:
            store.tidy()


# ---------------------------------------------------------------------- work
@contextmanager
def interruptible(note: str) -> Iterator[None]:
    """Turn Ctrl-C inside the context into `Interrupted`; `note` says what is stored and how to continue."""
    try:
        yield
    except KeyboardInterrupt:
        raise Interrupted(note) from None


@contextmanager
def working(note: str, quiet: bool) -> Iterator[Callable[[Any], None] | None]:
    """Run an interruptible computation; yield the argument for its ``progress=``, which shows progress on a terminal or in a log."""
    from ..long_work import shown

    with interruptible(note), shown(not quiet) as progress:
        yield progress


R = TypeVar("R", "Graph", "Chart")


def finished_of(kind: type[R], target: Path, fingerprint: str, quiet: bool, *, problems: bool) -> R | None:
    """Return the finished result of a run from its file; None if there is no file, or its run is unfinished.

    Raises
    ------
    ValueError
        If the file is invalid, or belongs to another run.
    """
    from ..store import Store

    if not target.exists():
        return None
    with Store.open(target) as store:
        store.require(fingerprint)
        if store.finished:
            found = store.graph(problems=problems)
            if not isinstance(found, kind):
                raise ValueError(f"{target}: this file holds another result; choose another name with -o.")
            return found
        say(f"{target} is unfinished: going on after {store.records} finished pieces of work.", quiet)
        return None


def made(target: Path, fingerprint: str, study: dict[str, Any], quiet: bool, make: Callable[..., R]) -> R:
    """Compute a result by ``make(journal=..., progress=...)`` with the file `target` as journal; the file also stores the study."""
    from ..store import Store

    note = f"all finished points are kept in {target}; the same command goes on from there"
    with Store.attach(target, fingerprint, study) as store:
        with working(note, quiet) as progress:
            found = make(journal=store, progress=progress)
        store.tidy()
    return found


def journal_of(target: Path) -> Path:
    """Return the path of the journal of an unfinished sweep or survey."""
    return target.with_name(target.name + ".unfinished")


def refuse_another(target: Path, header: dict[str, str]) -> None:
    """Raise an error if the journal beside a file has rows of another study, which would be lost.

    Parameters
    ----------
    target : Path
        The result's file.
    header : dict
        First line of this study's journal.

    Raises
    ------
    ValueError
        If it has.
    """
    from ..shared.row_journal import rows_of_another

    count = rows_of_another(journal_of(target), header)
    if count:
        raise ValueError(
            f"{target}: here {count} rows of an {header['contvines']} of another study (or of this one before it "
            "was edited) are kept; --fresh sets them aside, -o gives another name."
        )


# ---------------------------------------------------------------------- results
def load_file(file: Path, trust: bool = False, problems: bool = True) -> Graph:
    """Load the graph of a file; raise a ValueError for a chart."""
    from ..graph import Graph
    from ..store import load

    graph = load(file, problems=problems, trust=trust)
    if not isinstance(graph, Graph):
        raise ValueError(f"{file}: this file holds a chart; give one that `contvines diagram` has made.")
    return graph


def point_of(graph: Graph | Chart, label: str) -> tuple[Any, int | None]:
    """Return the object with a label and, for a label such as ``B1:12``, the number of the point on the branch or locus, otherwise None.

    Raises
    ------
    KeyError, ValueError
        If there is no such label, or no such point.
    """
    name, _, place = label.partition(":")
    found: Any = graph[name]
    if not place:
        return found, None
    if not hasattr(found, "__len__"):
        raise ValueError(f"{label}: {name} is a single point; leave out :{place}.")
    last = len(found) - 1
    if not (place.isdigit() and int(place) <= last):
        raise ValueError(
            f"{label}: the points of {name} are numbered from 0 to {last}; for example {name}:{last // 2}."
        )
    return found, int(place)


def check_special(graph: Graph, file: Path, label: str) -> None:
    """Raise a ValueError if a label is not that of a special point."""
    if label not in graph.special:
        fault = "is a branch" if label in graph.branches else "is no label of it"
        same_kind = [
            name for name in graph.special if name.rstrip("0123456789") == label.rstrip("0123456789")
        ]
        labels = [*(same_kind or graph.special)]
        more = f" and {len(labels) - MOST_NAMED} more" if len(labels) > MOST_NAMED else ""
        raise ValueError(
            f"{file}: {label} {fault}; its special points are {', '.join(labels[:MOST_NAMED]) or 'none'}{more}."
        )


def refuse_detached(graph: Graph, *labels: str) -> None:
    """Raise a ValueError, before any work, if a special point has no problem attached; the message gives reason and remedy."""
    from ..problems.registry import without_problem

    for label in labels:
        point = graph.special[label]
        if point.problem is None:
            branch = graph.branches.get(point.branch)
            raise ValueError(without_problem(label, None if branch is None else branch.description))


def refuse_unfinished(graph: Graph | Chart, file: Path) -> None:
    """Raise a ValueError if the run that makes a result is unfinished."""
    if not graph.finished:
        raise ValueError(f"{file}: this file is unfinished; run the command that made it again first.")


def say_state(graph: Graph | Chart, file: Path, problems: bool = True) -> None:
    """Print which branches were loaded as numbers only, and why, and whether the run is unfinished."""
    from ..graph import Graph
    from ..problems.registry import without_problem

    for branch in graph.branches.values() if problems and isinstance(graph, Graph) else ():
        if branch.problem is None and branch.description.get("factory") and not branch.default_measure:
            typer.echo(f"contvines: {without_problem(branch.label, branch.description)}.", err=True)
            break
    if not graph.finished:
        typer.echo(
            f"{file} is unfinished: its run goes on, or was stopped; the same command continues it.", err=True
        )


def tell(found: object, data: object = None) -> None:
    """Print a result: `data` as one JSON object if given, otherwise `found` as text."""
    if data is None:
        typer.echo(str(found))
        return
    from ..export import json_text

    typer.echo(json_text(data))


def tell_result(found: Graph | Chart, file: Path, details: bool) -> None:
    """Print the summary of a result, then its tables if they are short or `details` is true."""
    from ..graph import Graph

    size = len(found.branches if isinstance(found, Graph) else found.loci)
    brief = size > MANY and not details
    if isinstance(found, Graph):
        from ..graph.table import summary

        whole = f"{size} branches, {len(found.special)} special points"
        judged = any(branch.stable is not None for branch in found.branches.values())
        first = summary(found, brief=brief) if judged else ""
    else:
        from ..loci.table import chart_summary

        whole = f"{size} loci, {len(found.points)} points"
        first = chart_summary(found) if size > MANY else ""
    if first:
        typer.echo(first + "\n")
    if not (brief and first):
        typer.echo(str(found))
        return
    typer.echo(f"{whole}: contvines show {file}")
    if found.message not in ("", "finished"):
        typer.echo(fitted(found.message))


def present(found: Any, json: bool, plot: Path | None, size: tuple[float, float] | None) -> None:
    """Print a result as text or (by its ``to_dict``) as JSON, and draw it by its ``plot`` if a picture is wanted."""
    tell(found, found.to_dict() if json else None)
    draw(plot, lambda: found.plot(figsize=size), json)


def draw(plot: Path | None, figure: Callable[[], Any], quiet: bool = False) -> None:
    """Draw and save a picture, if one is wanted, and print its path."""
    if plot is not None:
        from ..plots.figures import save_figure

        save_figure(figure(), plot)
        say(f"drawn in {plot}", quiet)
