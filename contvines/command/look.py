"""`contvines show`, `orbit`, `plot` and `export`: the commands that look at results."""

import math
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from contvines.command.compare import CompareOption, check_compared, compared
from contvines.command.options import FileArgument, TrustOption
from contvines.graph.table import with_unit

JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object, numbers at full precision.")]


class Format(StrEnum):
    """What `export` writes."""

    csv = "csv"
    json = "json"
    graphml = "graphml"
    mat = "mat"


class Picture(StrEnum):
    """What `plot` draws."""

    diagram = "diagram"
    multipliers = "multipliers"
    network = "network"


class Colors(StrEnum):
    """What a colour of a diagram stands for."""

    branch = "branch"
    word = "word"
    stability = "stability"


def show(file: FileArgument, json: JsonOption = False) -> None:
    """List branches, special points and switches."""
    from contvines.store import load

    graph = load(file, problems=False)
    if json:
        from contvines.export import json_text

        typer.echo(json_text(graph.to_dict()))
        return
    if not graph.finished:
        _unfinished(file)
    typer.echo(str(graph))
    if "page" in graph.model:
        from orbits.machines.declared.stored import page_changed

        changed = page_changed(graph.model)
        if changed:
            typer.echo(f"{file}: {changed}", err=True)


def orbit(
    file: Annotated[
        Path, typer.Argument(metavar="FILE.vines|STUDY.toml", help="A result, or a study to try its start.")
    ],
    label: Annotated[
        str | None,
        typer.Argument(
            metavar="[LABEL]", help="With FILE.vines: a special point (SB1), or a point of a branch (B1:12)."
        ),
    ] = None,
    json: JsonOption = False,
    plot: Annotated[
        Path | None, typer.Option("--plot", metavar="FILE.png", help="Draw phase portrait and history.")
    ] = None,
    trust: TrustOption = False,
) -> None:
    """One orbit: its events, multipliers and margins."""
    if plot is not None:
        from contvines.plots.figures import check_picture

        check_picture(plot)
    found = _orbit(file, label, trust)
    if json:
        from contvines.export import json_text

        typer.echo(json_text(_plain(found)))
    else:
        typer.echo(_describe(found))
    if plot is not None:
        from contvines.command.compose import say
        from contvines.plots.figures import save_figure
        from contvines.plots.portrait import plot_portrait

        save_figure(plot_portrait(found), plot)
        say(f"drawn in {plot}")


def plot(
    file: FileArgument,
    x: Annotated[
        str | None, typer.Option("-x", help="Measure on the x axis; by default the parameter.")
    ] = None,
    y: Annotated[
        str | None,
        typer.Option(
            "-y",
            help="Measure on the y axis; by default what the machine is judged by: B (velocity at the first impact) "
            "of the absorber, max_abs_q1 of the coupled machine, the first measure of other problems.",
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE.png", help="png, pdf or svg.")
    ] = None,
    kind: Annotated[Picture, typer.Option("--kind", help="What to draw.")] = Picture.diagram,
    compare: CompareOption = None,
    branch: Annotated[str | None, typer.Option("--branch", help="Whose multipliers; by default B1.")] = None,
    xlim: Annotated[
        tuple[float, float] | None, typer.Option("--xlim", metavar="LOW HIGH", help="Limits of the x axis.")
    ] = None,
    ylim: Annotated[
        tuple[float, float] | None, typer.Option("--ylim", metavar="LOW HIGH", help="Limits of the y axis.")
    ] = None,
    size: Annotated[
        tuple[float, float] | None,
        typer.Option("--size", metavar="WIDTH HEIGHT", help="Inches; 3.4 2.4 is a column of a journal."),
    ] = None,
    color: Annotated[Colors | None, typer.Option("--color", help="What a colour stands for.")] = None,
    words: Annotated[bool, typer.Option("--words", help="Write words along the branches.")] = False,
    legend: Annotated[bool, typer.Option("--legend/--no-legend", help="Explain lines and marks.")] = True,
    style: Annotated[
        str | None, typer.Option("--style", help="A style or style sheet of matplotlib's, before ours.")
    ] = None,
    trust: TrustOption = False,
) -> None:
    """Draw a result: the diagram, the multipliers of a branch, or the graph itself."""
    from contvines.command.compose import beside
    from contvines.plots.figures import check_picture, check_style, save_figure
    from contvines.store import load

    asked = {"-x": x, "-y": y, "--xlim": xlim, "--ylim": ylim, "--color": color, "--words": words or None}
    asked |= {"--compare": compare[0] if compare else None}
    check_compared(compare, True)
    asked |= {"--no-legend": None if legend else "", "--branch": branch}
    _refuse_ignored(kind, asked)
    target = output or beside(file, ".png")
    check_picture(target)
    check_style(style)
    for name, pair in (("--xlim", xlim), ("--ylim", ylim)):
        if pair is not None and not (math.isfinite(sum(pair)) and pair[0] < pair[1]):
            raise ValueError(
                f"{name} {pair[0]:g} {pair[1]:g}: give the lower number first, then the higher one."
            )
    if size is not None and not all(1.0 <= side <= 60.0 for side in size):
        raise ValueError(f"--size {size[0]:g} {size[1]:g}: give inches between 1 and 60, such as 3.4 2.4.")
    graph = load(file, trust=trust)
    if hasattr(graph, "loci"):
        from contvines.plots.chart import plot_chart

        _refuse_of_chart(file, kind, asked)
        save_figure(plot_chart(graph, figsize=size, style=style), target)
        typer.echo(str(target))
        return
    _say_what_lacks(graph)
    if not graph.finished:
        _unfinished(file)
    if not graph.branches:
        raise ValueError(f"{file} has no finished branch yet; run the command that made it again.")
    if kind is Picture.diagram:
        figure = compared(
            graph,
            compare,
            x,
            y,
            words=words,
            color=(color or Colors.branch).value,
            legend=legend,
            xlim=xlim,
            ylim=ylim,
            figsize=size,
            style=style,
        )
    elif kind is Picture.network:
        from contvines.plots.network import plot_network

        figure = plot_network(graph, figsize=size, style=style)
    else:
        from contvines.plots.multipliers import plot_multipliers

        label = branch or next(iter(graph.branches))
        if label not in graph.branches:
            raise ValueError(
                f"--branch {label}: there is no such branch in {file}; it has {', '.join(graph.branches)}."
            )
        figure = plot_multipliers(graph.branches[label], figsize=size, style=style)
    save_figure(figure, target)
    typer.echo(str(target))


def export(
    file: FileArgument,
    to: Annotated[Format, typer.Option("--to", help="The format.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="PATH", help="Where to; by default FILE.FORMAT here."),
    ] = None,
    trust: TrustOption = False,
) -> None:
    """Write a result for other programs: csv, json, graphml or mat.

    csv has a row per point of every branch: the unknowns u0, u1 ..., then
    multipliers, word, periods and all measures (empty where not defined).
    mat has the same, a struct per branch; json and graphml are summaries.

    The unknowns follow the events in the word's order: at an impact the
    forcing's phase (radians) and the absorber's velocity after it (times
    1 + mass ratio, as B_post); at a turn, a stick and its slip the phase and
    the displacement w. In the coupled machine v and v_rate follow each pair.
    A symmetric branch has those of the first half of its word; the other half
    is their mirror image. The stuck absorber has no events: its u are the
    oscillator's sine and cosine (0 in the reduced machine).
    """
    from contvines.command.compose import beside
    from contvines.export import check_target
    from contvines.export import export as write
    from contvines.store import load

    target = output or beside(file, f".{to.value}")
    check_target(target, to.value)
    measures = to in (Format.csv, Format.mat)
    graph = load(file, problems=measures, trust=trust)
    if hasattr(graph, "loci"):
        from contvines.export.charts import export_chart

        typer.echo(str(export_chart(graph, to.value, target)))
        return
    if measures:
        _say_what_lacks(graph)
    if not graph.finished:
        _unfinished(file)
    typer.echo(str(write(graph, to.value, target)))


def _refuse_of_chart(file: Path, kind: Picture, options: dict[str, Any]) -> None:
    """Options that the picture of a chart would ignore are refused."""
    for name, value in {**options, "--kind": None if kind is Picture.diagram else kind.value}.items():
        if value is not None:
            raise ValueError(
                f"{name}{_given(value)}: {file} holds a chart, whose picture has no use for it; leave {name} out."
            )


def _refuse_ignored(kind: Picture, options: dict[str, Any]) -> None:
    """Options that this kind of picture would ignore are refused."""
    of_diagrams = ("-x", "-y", "--xlim", "--ylim", "--color", "--words", "--no-legend", "--compare")
    takes = {
        Picture.diagram: (of_diagrams, "draws all branches"),
        Picture.multipliers: (("--branch",), "draws over the parameter"),
        Picture.network: ((), "draws boxes and arrows"),
    }
    known, why = takes[kind]
    for name, value in options.items():
        if value is not None and name not in known:
            other = Picture.multipliers if name == "--branch" else Picture.diagram
            raise ValueError(
                f"{name}{_given(value)}: --kind {kind.value} {why} and has no use for it; leave {name} out, "
                f"or choose --kind {other.value}."
            )


def _given(value: Any) -> str:
    """An option's value as it was typed; nothing for a switch."""
    if isinstance(value, bool) or value == "":
        return ""
    return " " + (" ".join(f"{v:g}" for v in value) if isinstance(value, tuple) else str(value))


def _orbit(file: Path, label: str | None, trust: bool) -> Any:
    from contvines.command.study import is_database

    if not is_database(file) and file.suffix == ".toml":
        from contvines.command.compose import checked_study, first_orbit

        if label is not None:
            raise ValueError(
                f"{label}: a study has no labels yet; leave the label out, or give a .vines file."
            )
        return first_orbit(checked_study(file))
    from contvines.problems.registry import without_problem
    from contvines.store import load

    graph = load(file, trust=trust)
    if label is None:
        raise ValueError(
            f"which orbit of {file}? Give one of the labels {', '.join([*graph.special, *graph.branches])}."
        )
    name, _, place = label.partition(":")
    thing = graph[name]
    if hasattr(thing, "kind") and not place:
        if thing.problem is None:
            raise ValueError(without_problem(name, graph.branches[thing.branch].description))
        return thing.orbit
    if hasattr(thing, "kind"):
        raise ValueError(f"{label}: {name} is a single point; leave out :{place}.")
    last = len(thing) - 1
    if place and not (place.isdigit() and int(place) <= last):
        raise ValueError(
            f"{label}: the points of {name} are numbered from 0 to {last}; {name}:{last // 2} would do."
        )
    return thing.orbit(int(place or 0))


def _plain(found: Any) -> dict[str, Any]:
    if hasattr(found, "to_dict"):
        return found.to_dict()
    names = [n for n in ("parameter", "value", "u", "points") if hasattr(found, n)]
    return {n: getattr(found, n) for n in names}


# which measure's unit an event's number has
EVENTS = {
    "B_pre": "B_pre",
    "B_post": "B_post",
    "w": "max_abs_w",
    "w_rate": "B",
    "v": "max_abs_w",
    "v_rate": "B",
}


def _describe(found: Any) -> str:
    """An orbit as a readable text, from the same object that --json prints."""
    about = _plain(found)
    lines = []
    if "word" in about:
        nature = "real" if about["real"] else "virtual: no machine follows it"
        lines.append(f"{about['word'] or about.get('rest', 'stuck')}  k = {about['periods']}  ({nature})")
    parameters = about.get("parameters", {})
    if parameters:
        units = about.get("units", {})
        lines.append(
            "  " + "  ".join(f"{k} = {v:.10g} {units.get(k, '')}".rstrip() for k, v in parameters.items())
        )
    nodes = about.get("nodes", [])
    if nodes:
        names = list(nodes[0])
        table = [
            [
                with_unit(name, EVENTS.get(name) and about.get("units", {}).get(EVENTS[name]))
                for name in names
            ],
            *[[_number(n[k]) if isinstance(n[k], float) else str(n[k]) for k in names] for n in nodes],
        ]
        widths = [max(len(row[i]) for row in table) for i in range(len(names))]
        lines += ["  " + "  ".join(c.rjust(w) for c, w in zip(row, widths)) for row in table]
    if "multipliers" in about:
        pairs = about["multipliers"]
        text = ", ".join(
            _number(re) if _number(im) == "0" else f"{_number(re)}{im:+.10g}i" for re, im in pairs
        )
        if any(math.isnan(part) for pair in pairs for part in pair):
            text = "not defined at a graze"
        lines.append(f"  multipliers: {text or 'none'}")
    if about.get("margins"):
        smallest = min(about["margins"], key=lambda m: m["value"])
        lines.append(
            f"  smallest margin: {smallest['value']:.6g} ({smallest['kind']}, segment {smallest['segment']}) "
            f"of {len(about['margins'])}"
        )
    if not lines:
        lines = [f"{k}: {v}" for k, v in about.items()]
    return "\n".join(lines)


def _number(value: float) -> str:
    """Ten digits; what is only rounding is 0."""
    return "0" if abs(value) < 1e-15 else f"{value:.10g}"


def _say_what_lacks(graph: Any) -> None:
    """Branches that were loaded as numbers only, and why, on stderr; they are drawn and written without measures."""
    from contvines.problems.registry import without_problem

    for branch in graph.branches.values():
        if branch.problem is None and branch.description.get("factory"):
            typer.echo(f"contvines: {without_problem(branch.label, branch.description)}.", err=True)
            return


def _unfinished(file: Path) -> None:
    typer.echo(
        f"{file} is unfinished: its run goes on, or was stopped; the same command continues it.", err=True
    )
