"""The graph as tables: text that fits a terminal, or everything; HTML for notebooks."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ..bifurcation.kinds import BORDERS, KINDS
from ..branches.special_point import TRANSCRITICAL
from ..continuation.settings import Settings
from ..shared.number_text import figures_in
from ..text_table import Table, fitted, terminal_width
from .proving import mark, proof_text
from .shortening import short_text, short_word, short_words
from .unresolved import sentences

if TYPE_CHECKING:
    from ..branches.branch import Branch
    from .attractor import Attractor
    from .graph import Graph

LEFT = tuple(kind.name for kind in KINDS if kind.leaves)  #: kinds that solutions leave


def table(graph: Graph, width: int | None = None) -> str:
    """Branches, special points and switches as text.

    Parameters
    ----------
    graph : Graph
    width : int, optional
        Characters to a line; None: as many as it takes.
    """
    about = [title(graph), graph.start] if graph.start else [title(graph)]
    lines = [
        *(fitted(line, width) if width else line for line in about),
        "",
        *branches_table(graph).lines(width),
    ]
    if graph.special:
        lines += ["", *special_table(graph).lines(width)]
    if graph.unresolved:
        lines += ["", *sentences(graph.unresolved, graph.parameter)]
    if graph.attractors:
        lines += ["", *attractors_table(graph).lines(width), "", simulated(graph)]
    return "\n".join(lines)


def shown(graph: Graph) -> str:
    """The same as it fits the terminal, if one shows it."""
    return table(graph, terminal_width())


def title(graph: Graph) -> str:
    """What the tables are of, in one line."""
    count = len(graph.branches)
    low, high = graph.within
    unit = graph.units.get(graph.parameter, "")
    line = f"{count} branch{'' if count == 1 else 'es'} in {graph.parameter} within [{low:.6g}, {high:.6g}] {unit}"
    return line.rstrip() + ("" if graph.finished else " (unfinished)")


def parameter_head(graph: Graph) -> str:
    """The parameter as the head of a column, with its unit."""
    return with_unit(graph.parameter, graph.units.get(graph.parameter))


def branches_table(graph: Graph) -> Table:
    """A row per branch: what it is, where it is and is stable, and the special points at its ends, or why it ends."""
    name = parameter_head(graph)
    rows = []
    for branch in graph.branches.values():
        low, high = branch.range
        inner = [] if branch.stable is None else branch.stable_intervals()
        number = figures_in(graph.within, [low, high, *(end for interval in inner for end in interval)])
        stable = stable_text(branch, number)
        where = f"{number(low)}..{number(high)}"
        proved = proof_text(graph, branch.label)
        rows.append((branch.label, describe(branch), where, stable, proved, str(len(branch)), ends(branch)))
    head = (
        "branch",
        "what",
        name,
        "stable",
        "proved" if any(row[4] for row in rows) else "",
        "points",
        "from .. to",
    )
    return Table(head, rows, ("points", "from .. to"))


def special_table(graph: Graph, reasons: bool = True) -> Table:
    """A row per special point: its kind, branch, value, what it leads to, and with `reasons` why."""
    name = parameter_head(graph)
    rows, width = [], graph.within[1] - graph.within[0]
    number = figures_in(graph.within, [point.value for point in graph.special.values()])
    for point in graph.special.values():
        side = point.criticality or (TRANSCRITICAL if TRANSCRITICAL in point.remarks else "")
        remarks = [side, "" if point.real else "virtual", mark(graph, point.label)]
        if point.kind != "end" and any(
            abs(point.value - end) <= Settings.located * width for end in graph.within
        ):
            remarks.append("at the end")
        targets = []
        for switch in graph.switches:
            if switch.point == point.label:
                arrow = f"{switch.source} -> {switch.target}"
                targets.append(f"{arrow} ({short_words(switch.note)})" if switch.note and reasons else arrow)
        open_end = point.real if point.kind in BORDERS else point.kind in LEFT
        remarked = [remark for remark in point.remarks if remark != TRANSCRITICAL]
        if reasons and not targets and open_end and remarked:
            targets.append(f"({'; '.join(remarked)})")
        about = " ".join(filter(None, remarks))
        value = number(point.value)
        rows.append((point.label, point.kind, point.branch, value, about, "; ".join(targets)))
    return Table(("point", "kind", "on", name, "", "leads to"), rows, ("",))


def attractors_table(graph: Graph, most: int | None = None) -> Table:
    """A row per motion that simulated starts have met: where, and its share of the starts, over the interval and at most.

    With `most` so many of them, those with the largest shares first.
    """
    name = parameter_head(graph)
    values = np.array(sorted({a.value for a in graph.attractors if a.starts}))
    low, high = graph.within
    edges = np.concatenate([[low], 0.5 * (values[1:] + values[:-1]), [high]])
    parts = dict(zip(values.tolist(), (np.diff(edges) / (high - low)).tolist(), strict=True))
    met: dict[tuple[str, str, int], list[Attractor]] = {}
    for about in graph.attractors:
        key = (about.branch or "", about.name, about.periods)
        met.setdefault(key, []).append(about)
    rows = []
    number = figures_in(graph.within)
    shares = {key: sum(a.share * parts[a.value] for a in seen if a.starts) for key, seen in met.items()}
    listed = list(met) if most is None else sorted(met, key=lambda key: -shares[key])[:most]
    for label, motion, periods in listed:
        seen, share = met[label, motion, periods], shares[label, motion, periods]
        span = f"{number(seen[0].value)}..{number(seen[-1].value)}"
        where = span if len(seen) > 1 else number(seen[0].value)
        rows.append(
            (
                f"{short_word(motion)} k={periods}" if periods else motion,
                label,
                where,
                str(len(seen)),
                f"{share:.2%}",
                f"{max(a.share for a in seen):.0%}",
            )
        )
    if len(listed) < len(met):
        rows.append((f"and {len(met) - len(listed)} more", *[""] * 5))
    return Table(
        ("attractor", "branch", f"met at {name}", "values", "share of starts", "at most"), rows, ("values",)
    )


def simulated(graph: Graph) -> str:
    """At how many values an atlas has simulated, how long nothing new was met, and where nothing is known, in a sentence."""
    count = len({a.value for a in graph.attractors if a.starts})
    line = f"starts simulated at {count} value{'' if count == 1 else 's'} of {graph.parameter}"
    number = figures_in(graph.within)
    if empty := graph.settings.get("unknown"):
        stretches = ", ".join(f"{number(a)}..{number(b)}" for a, b in empty)
        line += f"; what attracts on {stretches} is not known: give values there, or raise scan or budget"
    scanned, quiet = graph.settings.get("scanned"), graph.settings.get("quiet", 0)
    if not scanned:
        return line
    if quiet >= graph.settings["scan"]:
        line += f"; of {scanned} scattered ones the last {quiet} met nothing new"
    else:
        line += f"; {scanned} scattered ones met something new again and again, the last {quiet} did not: raise scan to look on"
    ends, left = graph.settings.get("followed", 0), graph.settings.get("unfollowed", 0)
    if ends:
        line += f"; at {ends} end{'' if ends == 1 else 's'} of stability the motion was followed to what comes after it"
    return f"{line}; {left} more are left: raise scan" if left else line


def stable_text(branch: Branch, number: Callable[[float], str]) -> str:
    """Where a branch is stable, with numbers as `number` writes them; "-" nowhere, or that it is not computed."""
    if branch.stable is None:
        return "not computed"
    return ", ".join(f"{number(a)}..{number(b)}" for a, b in branch.stable_intervals()) or "-"


def describe(branch: Branch) -> str:
    """A branch in a few words: its motion's word, periods, symmetry, virtual or not."""
    about = branch.description
    parts = (
        short_word(str(about.get("word") or about.get("name", ""))),
        f"k={about['periods']}" if "periods" in about else "",
        "symmetric" if about.get("symmetric") else "",
        "" if branch.real else "virtual",
    )
    return " ".join(part for part in parts if part)


def ends(branch: Branch) -> str:
    """The labels at both ends of a branch; where there is none, why it ends there, shortened; "closed" for a circle."""
    if branch.closed:
        return "closed"
    at = dict(reversed(branch.marks))
    first, last = (at.get(i, "") for i in (0, len(branch) - 1))
    texts = [
        label or short_text(short_words(why)) or "?"
        for label, why in zip((first, last), branch.ended, strict=True)
    ]
    if texts[0] == texts[1] and not first:
        return f"{texts[0]} (both ends)"
    return " .. ".join(texts)


def with_unit(name: str, unit: str | None) -> str:
    """A name as the head of a column."""
    return f"{name} [{unit}]" if unit else name
