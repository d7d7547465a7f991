"""Tables of a graph: as text, complete or fitted to a terminal, and as HTML for notebooks."""

from __future__ import annotations

import html
import re
import textwrap
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from ..bifurcation.kinds import BORDERS, KINDS
from ..branches import Branch
from ..branches.special_point import TRANSCRITICAL, SpecialPoint
from ..continuation.settings import Settings
from ..shared.motions import MODULATIONS
from ..shared.numbers import PART, complex_figures, figures, figures_in
from ..shared.numbers import number_text as number
from ..text_table import Table, fitted, terminal_width
from . import Graph
from .contents import Attractor, proof_mark, proof_text, sentences
from .stretches import Stretch, at_points, default_measure, gaps, stretches, united

MOST = 8  # largest number of motions in a summary
LEFT = tuple(kind.name for kind in KINDS if kind.leaves)  #: kinds of points that branches leave


def table(graph: Graph, width: int | None = None) -> str:
    """Return the branches, special points and switches as text.

    Parameters
    ----------
    graph : Graph
    width : int, optional
        Characters per line; None for no limit.
    """
    head = [title(graph), graph.start] if graph.start else [title(graph)]
    lines = [
        *(fitted(line, width) if width else line for line in head),
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
    """Return the table, fitted to the terminal if there is one."""
    return table(graph, terminal_width())


def title(graph: Graph) -> str:
    """Return one line above the tables: number of branches, parameter, interval."""
    count = len(graph.branches)
    low, high = graph.within
    unit = graph.units.get(graph.parameter, "")
    line = f"{count} branch{'' if count == 1 else 'es'} in {graph.parameter} within [{low:.6g}, {high:.6g}] {unit}"
    return line.rstrip() + ("" if graph.finished else " (unfinished)")


def parameter_head(graph: Graph) -> str:
    """Return the parameter with its unit, as the head of a column."""
    return with_unit(graph.parameter, graph.units.get(graph.parameter))


def branches_table(graph: Graph) -> Table:
    """Return a table with a row per branch: motion, interval, stable intervals, and the special points at its ends, or the reasons for the ends."""
    name = parameter_head(graph)
    rows = []
    for branch in graph.branches.values():
        low, high = branch.range
        inner = [] if branch.stable is None else branch.stable_intervals()
        number = figures_in(graph.within, [low, high, *(end for interval in inner for end in interval)])
        stable = stable_text(branch, number)
        span = f"{number(low)}..{number(high)}"
        proved = proof_text(graph, branch.label)
        rows.append((branch.label, describe(branch), span, stable, proved, str(len(branch)), ends(branch)))
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
    """Return a table with a row per special point: kind, branch, value, and branches to which it leads; with `reasons` also notes and remarks."""
    name = parameter_head(graph)
    rows, width = [], graph.within[1] - graph.within[0]
    number = figures_in(graph.within, [point.value for point in graph.special.values()])
    for point in graph.special.values():
        side = point.criticality or (TRANSCRITICAL if TRANSCRITICAL in point.remarks else "")
        remarks = [side, "" if point.real else "virtual", proof_mark(graph, point.label)]
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
        notes = " ".join(filter(None, remarks))
        value = number(point.value)
        rows.append((point.label, point.kind, point.branch, value, notes, "; ".join(targets)))
    return Table(("point", "kind", "on", name, "", "leads to"), rows, ("",))


def attractors_table(graph: Graph, most: int | None = None) -> Table:
    """Return a table with a row per motion reached by simulated starts: values, mean share of the starts over the interval, and largest share.

    `most` is the largest number of rows; those with the largest shares come first.
    """
    name = parameter_head(graph)
    values = np.array(sorted({a.value for a in graph.attractors if a.starts}))
    low, high = graph.within
    edges = np.concatenate([[low], 0.5 * (values[1:] + values[:-1]), [high]])
    parts = dict(zip(values.tolist(), (np.diff(edges) / (high - low)).tolist(), strict=True))
    by_motion: dict[tuple[str, str, int], list[Attractor]] = {}
    for attractor in graph.attractors:
        key = (attractor.branch or "", attractor.name, attractor.periods)
        by_motion.setdefault(key, []).append(attractor)
    rows = []
    number = figures_in(graph.within)
    shares = {
        key: sum(a.share * parts[a.value] for a in members if a.starts) for key, members in by_motion.items()
    }
    listed = list(by_motion) if most is None else sorted(by_motion, key=lambda key: -shares[key])[:most]
    for label, motion, periods in listed:
        members, share = by_motion[label, motion, periods], shares[label, motion, periods]
        span = f"{number(members[0].value)}..{number(members[-1].value)}"
        range_text = span if len(members) > 1 else number(members[0].value)
        rows.append(
            (
                f"{short_word(motion)} k={periods}" if periods else motion,
                label,
                range_text,
                str(len(members)),
                f"{share:.2%}",
                f"{max(a.share for a in members):.0%}",
            )
        )
    if len(listed) < len(by_motion):
        rows.append((f"and {len(by_motion) - len(listed)} more", *[""] * 5))
    return Table(
        ("attractor", "branch", f"met at {name}", "values", "share of starts", "at most"), rows, ("values",)
    )


def simulated(graph: Graph) -> str:
    """Return a sentence on an atlas's simulations: the number of values, how many of the last ones found nothing new, and intervals without results."""
    count = len({a.value for a in graph.attractors if a.starts})
    line = f"starts simulated at {count} value{'' if count == 1 else 's'} of {graph.parameter}"
    number = figures_in(graph.within)
    if empty := graph.settings.get("unknown"):
        stretches = ", ".join(f"{number(a)}..{number(b)}" for a, b in empty)
        line += f"; the attractors on {stretches} are not known: give values there, or raise scan or budget"
    scanned, fruitless = graph.settings.get("scanned"), graph.settings.get("quiet", 0)
    if not scanned:
        return line
    if fruitless >= graph.settings["scan"]:
        line += f"; the last {fruitless} of {scanned} scattered values showed nothing new"
    else:
        line += f"; {scanned} scattered values showed new motions again and again, except the last {fruitless}: raise scan to search further"
    ends, left = graph.settings.get("followed", 0), graph.settings.get("unfollowed", 0)
    if ends:
        line += (
            f"; at {ends} end{'' if ends == 1 else 's'} of stability the motion was followed to the next one"
        )
    return f"{line}; {left} more ends are left: raise scan" if left else line


def stable_text(branch: Branch, number: Callable[[float], str]) -> str:
    """Return the stable intervals of a branch as text, with numbers formatted by `number`; "-" if there are none, or "not computed"."""
    if branch.stable is None:
        return "not computed"
    return ", ".join(f"{number(a)}..{number(b)}" for a, b in branch.stable_intervals()) or "-"


def describe(branch: Branch) -> str:
    """Return a branch in short: its motion's word, periods, symmetry, and whether it is virtual."""
    data = branch.description
    parts = (
        motion_name(data),
        f"k={data['periods']}" if "periods" in data else "",
        "symmetric" if data.get("symmetric") else "",
        "" if branch.real else "virtual",
    )
    return " ".join(part for part in parts if part)


def ends(branch: Branch) -> str:
    """Return the labels at both ends of a branch, or the shortened reason for an end without a label; "closed" for a closed branch."""
    if branch.closed:
        return "closed"
    at = dict(reversed(branch.marks))
    first, last = (at.get(i, "") for i in (0, len(branch) - 1))
    texts = [
        label or short_text(short_words(reason)) or "?"
        for label, reason in zip((first, last), branch.ended, strict=True)
    ]
    if texts[0] == texts[1] and not first:
        return f"{texts[0]} (both ends)"
    return " .. ".join(texts)


def with_unit(name: str, unit: str | None) -> str:
    """Return a name with its unit, as the head of a column."""
    return f"{name} [{unit}]" if unit else name


# ------------------------------------------------------------------ long words, shortened for tables and captions; files have the whole words
def short_word(word: str, limit: int = 24) -> str:
    """Shorten a word of events to about `limit` characters.

    A word that repeats a shorter one is written as a power, ``(LtRLttR)^8``. If it is still too long it is cut, and the number of its events is
    added. Events are separated by blanks if their names are long; else each letter is an event, and signs as in ``s+`` belong to the event
    before them. Names of modulations are not changed.
    """
    if len(word) <= limit or word in MODULATIONS:
        return word
    joint = " " if " " in word else ""  # separator of the events
    length = (word + joint + word).find(word, 1)  # of the shortest root, separator included
    power = f"^{(len(word) + len(joint)) // length}" if length < len(word) else ""
    root = word[:length].rstrip()
    if len(root) > limit:
        plain = re.sub(r"\[[^\]]*\]", "", root)  # modes are no events
        events = len(plain.split()) if joint else sum(letter.isalpha() for letter in plain)
        cut = root[: limit - 8]
        root = f"{cut[: cut.rfind(joint)] if joint else cut}... {events} events"
    return f"({root}){power}" if power else root


def told_apart(words: Iterable[str], limit: int = 24) -> dict[str, str]:
    """Return short forms by word; forms of different words differ, and are longer than `limit` if necessary."""
    limits = dict.fromkeys(words, limit)
    while True:
        short = {word: short_word(word, most) for word, most in limits.items()}
        times = Counter(short.values())
        clashing = [word for word, most in limits.items() if times[short[word]] > 1 and most < len(word)]
        if not clashing:
            return short
        limits.update((word, 2 * limits[word]) for word in clashing)


def short_text(text: str) -> str:
    """Return a text on one line of at most 100 characters, cut between words."""
    return textwrap.shorten(text, 100, placeholder=" ...", break_on_hyphens=False)


def motion_name(description: Mapping[str, Any]) -> str:
    """Return the displayed name of a motion: its shortened word, or, without events, the problem's name for it ("stuck", "no events")."""
    return short_word(_word(description))


def _word(description: Mapping[str, Any]) -> str:
    """Return the word of a motion, or without one its name."""
    return str(description.get("word") or description.get("name", ""))


def short_words(text: str) -> str:
    """Return a sentence with its long words of events shortened."""
    return " ".join(short_word(part) for part in text.split(" "))


# ------------------------------------------------------------------ pages for notebooks
def graph_page(graph: Graph) -> str:
    """Return all tables of a graph as HTML."""
    head = f"<p>{title(graph)}</p>" + (f"<p>{html.escape(graph.start)}</p>" if graph.start else "")
    parts = [head, branches_table(graph).html()]
    if graph.special:
        parts.append(special_table(graph).html())
    parts += [f"<p>{html.escape(line)}</p>" for line in sentences(graph.unresolved, graph.parameter)]
    if graph.attractors:
        parts += [attractors_table(graph).html(), f"<p>{html.escape(simulated(graph))}</p>"]
    return "".join(parts)


def branch_page(branch: Branch) -> str:
    """Return the properties of a branch as an HTML table."""
    low, high = branch.range
    rows = [
        ("what", describe(branch)),
        (branch.parameter, f"{number(low, 10)}..{number(high, 10)}"),
        ("stable", stable_text(branch, lambda value: number(value, 6))),
        ("points", str(len(branch))),
        ("from .. to", ends(branch)),
        ("special points", ", ".join(label for _, label in branch.marks) or "-"),
    ]
    return Table((branch.label, "branch"), rows).html()


def point_page(point: SpecialPoint) -> str:
    """Return the properties of a special point as an HTML table."""
    rows = [
        (
            "kind",
            " ".join(filter(None, (point.criticality or "", point.kind, "" if point.real else "(virtual)"))),
        ),
        ("on", point.branch),
        (point.parameter, number(point.value, 14)),
        ("located to", number(point.location_error, 2)),
        ("multipliers", complex_figures(point.multipliers[:8]) or "-"),
        *([("note", point.note)] if point.note else []),
    ]
    return Table((point.label, "special point"), rows).html()


# ------------------------------------------------------------------ summary
def summary(graph: Graph, width: int | None = None, brief: bool = False) -> str:
    """Return a summary of the stable motions of a graph: word, type, intervals, largest response; and the part of the interval without one.

    Parameters
    ----------
    graph : Graph
    width : int, optional
        Characters per line; those of the terminal by default.
    brief : bool
        For an atlas, add the motions that most simulated starts reach. Used if no tables follow.
    """
    width = terminal_width() if width is None else width
    measure = default_measure(graph)
    groups: dict[tuple[str, str], list[Stretch]] = {}
    for part in stretches(graph):
        groups.setdefault((_word(part.branch.description), _kind(part.branch.description)), []).append(part)
    stable = {
        key: united((float(part.values.min()), float(part.values.max())) for part in parts)
        for key, parts in groups.items()
    }
    length = graph.within[1] - graph.within[0]
    lengths = {key: sum(high - low for low, high in spans) for key, spans in stable.items()}
    found = sorted(groups, key=lambda key: -lengths[key])
    listed = [key for key in found if lengths[key] >= PART * length][:MOST] or found[:MOST]
    short = told_apart(word for word, _ in listed)
    interval_ends = [end for key in listed for interval in stable[key] for end in interval]
    number = figures_in(
        graph.within, interval_ends, same=Settings.located * length
    )  # equal ends of two branches are one point
    rows = []
    for key in listed:
        top = max(map(at_points, groups[key]), key=lambda top: top.response)
        ends = [f"{number(a)}..{number(b)}" for a, b in stable[key]]
        rows.append(
            (
                short[key[0]],
                key[1],
                ", ".join(ends[:3]) + (f" and {len(ends) - 3} more" if len(ends) > 3 else ""),
                f"{figures(top.response)} at {number(top.value)}" if np.isfinite(top.response) else "-",
            )
        )
    unit = graph.units.get(graph.parameter)
    head = (
        "motion",
        "type",
        f"stable in {with_unit(graph.parameter, unit)}",
        f"largest {with_unit(measure, graph.units.get(measure))}",
    )
    lines = Table(head, rows).lines(width) if rows else ["no stable motion on these branches"]
    if rows:
        count = len(graph.branches)
        lines.insert(
            0, fitted(f"stable motions of {count} branch{'' if count == 1 else 'es'}, the widest first")
        )
    if len(found) > len(listed):
        lines.append(f"and {len(found) - len(listed)} more, on narrow stretches")
    open_ = gaps(graph)
    part = sum(b - a for a, b in open_) / length
    if part >= PART and rows:
        low, high = max(open_, key=lambda gap: gap[1] - gap[0])
        longest = f"{graph.parameter} = {number(low)} to {number(high)} {unit or ''}".rstrip()
        lines.append(
            fitted(
                f"no stable motion on a branch in {100.0 * part:.3g} % of the interval, most of it {longest}: modulated or chaotic motions, or motions that are not connected to these"
            )
        )
    if brief and graph.attractors:
        reached = attractors_table(graph, MOST)
        lines += ["", *reached.lines(width), "", fitted(simulated(graph))]
    return "\n".join(lines)


def _kind(data: Mapping[str, Any]) -> str:
    """Return the type of a motion in a few words: symmetric, period, without impacts."""
    periods = int(data.get("periods") or 0)
    parts = ["symmetric"] if data.get("symmetric") else []
    parts += [f"period {periods}"] if periods > 1 else []
    if data.get("impacts") == 0:
        parts.append("no impacts")
    return ", ".join(parts)
