"""`contvines orbit`: one orbit of a stored graph, or the start of a study."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from contvines.command.frame import draw, say, tell
from contvines.command.options import JsonOption, PlotOption, TrustOption, argument, option
from contvines.shared.number_text import complex_figures, figures
from contvines.text_table import fitted

if TYPE_CHECKING:
    from collections.abc import Callable

    from contvines.graph.graph import Graph
    from contvines.loci.chart import Chart


def orbit(
    file: Annotated[
        Path,
        argument("FILE.vines|STUDY.toml", "A result, or a study, whose first orbit is shown."),
    ],
    label: Annotated[
        str | None,
        argument("LABEL", "With FILE.vines: a special point (SB1), or a point of a branch (B1:12)."),
    ] = None,
    json: JsonOption = False,
    plot: PlotOption = None,
    animate: Annotated[
        Path | None,
        option("--animate FILE.gif", "Write an animation (gif, html; mp4 needs ffmpeg)."),
    ] = None,
    trust: TrustOption = False,
) -> None:
    """One orbit: its events, multipliers and margins."""
    from contvines.plots.portrait import plot_portrait

    if animate is not None:
        from contvines.shared.animations import check_animation

        check_animation(animate)

    found = _orbit(file, label, trust)
    tell(fitted(_describe(found)), _plain(found) if json else None)
    draw(plot, lambda: plot_portrait(found))
    if animate is not None:
        animated = getattr(found, "animate", None)
        if not callable(animated):
            raise ValueError(f"--animate {animate}: this solution has no motion to show; --plot draws it")
        animated(animate)
        say(f"animation written to {animate}")


def _orbit(file: Path, label: str | None, trust: bool) -> object:
    from contvines.command.study import read_study
    from contvines.file_names import is_database

    if not is_database(file) and file.suffix == ".toml":
        from contvines.command.compose import first_orbit

        if label is not None:
            raise ValueError(
                f"{label}: a study has no labels yet; leave the label out, or give a .vines file."
            )
        study = read_study(file)
        return _solution(first_orbit(study), study.within)
    from contvines.branches.special_point import SpecialPoint
    from contvines.graph.graph import Graph
    from contvines.loci.locus import PlanePoint
    from contvines.problems.registry import without_problem
    from contvines.store import load

    graph = load(file, trust=trust)
    if label is None:
        raise ValueError(f"which orbit of {file}? Give one of the labels {', '.join(_labels(graph))}.")
    name, _, place = label.partition(":")
    thing = graph[name]
    if isinstance(thing, SpecialPoint | PlanePoint):
        if place:
            raise ValueError(f"{label}: {name} is a single point; leave out :{place}.")
        if isinstance(thing, SpecialPoint) and isinstance(graph, Graph) and thing.problem is None:
            raise ValueError(without_problem(name, graph.branches[thing.branch].description))
        return thing.orbit
    last = len(thing) - 1
    if place and not (place.isdigit() and int(place) <= last):
        raise ValueError(
            f"{label}: the points of {name} are numbered from 0 to {last}; for example {name}:{last // 2}."
        )
    return thing.orbit(int(place or 0))


def _labels(graph: "Graph | Chart") -> list[str]:
    """All labels of a graph or chart."""
    from contvines.graph.graph import Graph

    if isinstance(graph, Graph):
        return [*graph.special, *graph.branches]
    return [*graph.points, *graph.loci]


def _solution(start: object, within: tuple[float, float]) -> object:
    """The start of a study: an orbit as it is; of a problem (equilibria, cycles of maps) its first solution."""
    from contvines.problems.abilities import Started

    if not isinstance(start, Started):
        return start
    from contvines.continuation.engine import Engine
    from contvines.continuation.settings import Settings
    from contvines.continuation.starts import problem_and_start, solve_start

    problem, u, p = problem_and_start(start, None)
    first = solve_start(Engine(problem, within, Settings()), u, p)
    return problem.orbit(first.u, first.p)


def _plain(found: object) -> dict[str, Any]:
    to_dict: Callable[[], dict[str, Any]] | None = getattr(found, "to_dict", None)
    if to_dict is not None:
        return to_dict()
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


def _stability(about: dict[str, Any]) -> str:
    """Whether a motion is stable, or why that is undecided."""
    from contvines.shared.stability import marginal_text

    if about["stable"] is None:
        return marginal_text(complex(re, im) for re, im in about["multipliers"])
    return "stable" if about["stable"] else "unstable"


def _describe(found: object) -> str:
    """An orbit as a readable text, from the same object that --json prints."""
    from contvines.graph.shortening import short_word
    from contvines.graph.table import with_unit
    from contvines.text_table import Table, terminal_width

    about = _plain(found)
    if "equilibrium" in about:
        return str(found)
    lines = []
    if "word" in about:
        nature = "real" if about["real"] else "virtual: no machine follows it"
        word = short_word(about["word"]) or about.get("rest", "stuck")
        lines.append(f"{word}  k = {about['periods']}  ({nature})")
    if "states" in about:  # a cycle of a flow
        lines.append(f"cycle of period {figures(about['period'])}  ({_stability(about)})")
    parameters = about.get("parameters", {})
    if parameters:
        units = about.get("units", {})
        lines.append(
            "  " + "  ".join(f"{k} = {v:.7g} {units.get(k, '')}".rstrip() for k, v in parameters.items())
        )
    nodes = about.get("nodes", [])
    if nodes:
        names = list(nodes[0])
        units = about.get("units", {})
        head = tuple(
            with_unit(name, None if name == "phase" else units.get(name) or units.get(EVENTS.get(name, "")))
            for name in names
        )
        rows = [tuple(figures(n[k]) if isinstance(n[k], float) else str(n[k]) for k in names) for n in nodes]
        width = terminal_width()
        lines += [f"  {line}" for line in Table(head, rows, right=head).lines(width and width - 2)]
    if "multipliers" in about:
        pairs = about["multipliers"]
        text = complex_figures(complex(re, im) for re, im in pairs)
        if any(math.isnan(part) for pair in pairs for part in pair):
            text = "not defined at a graze"
        elif text and "word" in about:
            text = f"{text}  ({_stability(about)})"
        lines.append(f"  multipliers: {text or 'none'}")
    if about.get("margins"):
        smallest = min(about["margins"], key=lambda m: m["value"])
        lines.append(
            f"  smallest margin: {figures(smallest['value'])} ({smallest['kind']}, segment {smallest['segment']}) "
            f"of {len(about['margins'])}"
        )
    if not lines:
        lines = [f"{k}: {v}" for k, v in about.items()]
    return "\n".join(lines)
