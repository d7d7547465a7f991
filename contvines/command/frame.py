"""The frame of every verb: the place of its result, progress, Ctrl-C, and what is printed and drawn at the end."""

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

MOST_NAMED = 24  # labels in one sentence


class Interrupted(Exception):
    """Ctrl-C in the middle of the work; the message says what is kept and how to go on."""


def say(text: str, quiet: bool = False) -> None:
    """A remark for the user, on stderr so that results on stdout stay clean."""
    if not quiet:
        print(fitted(text), file=sys.stderr)


# ---------------------------------------------------------------------- places
def beside(path: Path, ending: str) -> Path:
    """The default place of a result: the study's or file's name with another ending, in the current folder."""
    return Path(path.stem + ending)


def place_of(output: Path | None, source: Path, ending: str) -> Path:
    """Where a result goes: the place that was asked for, or the default, whose name ends so; refused before any work if it will not do.

    A result does not replace what it is made from.
    """
    path, kind = output or beside(source, ending), ending.rpartition(".")[2]
    if path.resolve() == source.resolve():
        what = "the study" if source.suffix == ".toml" else "the file"
        raise ValueError(f"{path}: this is {what} itself; choose another name with -o.")
    if kind == "vines":
        refuse_place(path)
        refuse_ending(path, kind)
    else:
        from ..export import check_target

        check_target(path, kind)
    return path


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
                aside = set_aside(target, *others, *logs)
            except OSError as error:
                raise ValueError(
                    f"{target}: cannot be set aside ({error.strerror}); choose another name with -o."
                ) from None
            if aside is not None:
                say(f"{target} is set aside as {aside}", quiet)
        yield
        if any(log.exists() for log in logs):
            _fold(target)


def _fold(target: Path) -> None:
    """Fold its log into a .vines file, unless that is damaged."""
    from ..store import Store, StoreError

    if target.suffix == ".vines" and target.exists():
        with suppress(StoreError), Store.open(target, write=True) as store:
            store.tidy()


# ---------------------------------------------------------------------- work
@contextmanager
def interruptible(note: str) -> Iterator[None]:
    """Ctrl-C ends the command with a sentence that says what is kept and how to go on."""
    try:
        yield
    except KeyboardInterrupt:
        raise Interrupted(note) from None


@contextmanager
def working(note: str, quiet: bool) -> Iterator[Callable[[Any], None] | None]:
    """Interruptible work; gives what to hand to ``progress=``, which tells a terminal, or a log, where the work is."""
    from ..long_work import shown

    with interruptible(note), shown(not quiet) as progress:
        yield progress


R = TypeVar("R", "Graph", "Chart")


def finished_of(kind: type[R], target: Path, fingerprint: str, quiet: bool, *, problems: bool) -> R | None:
    """The finished result of a run in its file; None if the run is still to be done, or to be gone on with.

    Raises
    ------
    ValueError
        If the file is refused, or belongs to another run.
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
    """What a run makes with ``journal=`` and ``progress=``, each finished point kept in its file, which keeps its study, too."""
    from ..store import Store

    note = f"all finished points are kept in {target}; the same command goes on from there"
    with Store.attach(target, fingerprint, study) as store:
        with working(note, quiet) as progress:
            found = make(journal=store, progress=progress)
        store.tidy()
    return found


# ---------------------------------------------------------------------- results
def load_file(file: Path, trust: bool = False, problems: bool = True) -> Graph:
    """The graph of a file; a chart is refused."""
    from ..graph import Graph
    from ..store import load

    graph = load(file, problems=problems, trust=trust)
    if not isinstance(graph, Graph):
        raise ValueError(f"{file}: this file holds a chart; give one that `contvines diagram` has made.")
    return graph


def point_of(graph: Graph | Chart, label: str) -> tuple[Any, int | None]:
    """What a label names, and of a branch or locus the number of a point where the label has one, as ``B1:12``.

    Raises
    ------
    KeyError, ValueError
        If there is no such label, or no such point.
    """
    name, _, place = label.partition(":")
    thing: Any = graph[name]
    if not place:
        return thing, None
    if not hasattr(thing, "__len__"):
        raise ValueError(f"{label}: {name} is a single point; leave out :{place}.")
    last = len(thing) - 1
    if not (place.isdigit() and int(place) <= last):
        raise ValueError(
            f"{label}: the points of {name} are numbered from 0 to {last}; for example {name}:{last // 2}."
        )
    return thing, int(place)


def check_special(graph: Graph, file: Path, label: str) -> None:
    """Refuse a label that is not that of a special point."""
    if label not in graph.special:
        what = "is a branch" if label in graph.branches else "is no label of it"
        alike = [name for name in graph.special if name.rstrip("0123456789") == label.rstrip("0123456789")]
        known = [*(alike or graph.special)]
        more = f" and {len(known) - MOST_NAMED} more" if len(known) > MOST_NAMED else ""
        raise ValueError(
            f"{file}: {label} {what}; its special points are {', '.join(known[:MOST_NAMED]) or 'none'}{more}."
        )


def refuse_detached(graph: Graph, *labels: str) -> None:
    """Special points whose problem is not at hand, before work starts: a sentence that says why, and a way out."""
    from ..problems.registry import without_problem

    for label in labels:
        point = graph.special[label]
        if point.problem is None:
            branch = graph.branches.get(point.branch)
            raise ValueError(without_problem(label, None if branch is None else branch.description))


def refuse_unfinished(graph: Graph | Chart, file: Path) -> None:
    """Work on a result begins when that is finished."""
    if not graph.finished:
        raise ValueError(f"{file}: this file is unfinished; run the command that made it again first.")


def say_state(graph: Graph | Chart, file: Path, problems: bool = True) -> None:
    """Branches that were loaded as numbers only, and why; whether the run goes on."""
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
    """Print a result: one JSON object where there is `data`, else as text."""
    if data is None:
        typer.echo(str(found))
        return
    from ..export import json_text

    typer.echo(json_text(data))


def tell_result(found: Graph | Chart, file: Path, details: bool) -> None:
    """What matters most of a result first; then its tables where they are short, or are asked for."""
    from ..graph import Graph

    size = len(found.branches if isinstance(found, Graph) else found.loci)
    brief = size > MANY and not details
    if isinstance(found, Graph):
        from ..graph.table import summary

        whole = f"{size} branches, {len(found.special)} special points"
        known = any(branch.stable is not None for branch in found.branches.values())
        first = summary(found, brief=brief) if known else ""
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
    """Print a result that has a text, ``to_dict`` and ``plot``, and draw it where a picture is wanted."""
    tell(found, found.to_dict() if json else None)
    draw(plot, lambda: found.plot(figsize=size), json)


def draw(plot: Path | None, figure: Callable[[], Any], quiet: bool = False) -> None:
    """Draw a picture where one is wanted, and say where it is."""
    if plot is not None:
        from ..plots.figures import save_figure

        save_figure(figure(), plot)
        say(f"drawn in {plot}", quiet)
