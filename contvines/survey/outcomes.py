"""Outcomes: numbers computed from a diagram.

An outcome is a function ``(found: Findings) -> {column: number}``. A *response* is the default measure of a diagram, on stable real
branches and of simulated motions; several responses may coexist at one value of the parameter.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.motions import BAND, is_strong

from ..coexistence.census import UNBRANCHED
from ..graph.stretches import COVERAGE, default_measure, gaps, highest, not_simulated, stretches, united
from ..shared.numbers import figures_in

if TYPE_CHECKING:
    from ..graph import Graph
    from .completion import Unbranched

Simulated = tuple[float, Mapping[str, float], str]
"""A motion on which a simulation settles: value of the parameter, measures by name, word."""
GRID = 401  # number of parameter values at which coexisting responses are compared
# share of the interval with known responses from which on a system counts as known
LEAST_SHARE = 1.0 - COVERAGE.least


@dataclass(frozen=True)
class Findings:
    """The computed results of one system, from which outcomes are computed.

    Attributes
    ----------
    graph : Graph
        Its diagram.
    seed : object
        Seed of the diagram (for a machine: an orbit, with the machine as its `model`).
    simulated : sequence of (float, dict, str)
        Motions on which a simulation settled: value of the parameter, measures by name, word; see `Job`.
    unbranched : sequence of Unbranched
        Attractors that lie on no branch of the diagram, for example chaotic ones.
    """

    graph: Graph
    seed: object
    simulated: Sequence[Simulated] = ()
    unbranched: Sequence[Unbranched] = ()


Outcome = Callable[[Findings], Mapping[str, float]]


def _highest(graph: Graph, measure: str | None = None) -> list[tuple[float, float]]:
    """Return (largest stable response of the branches, its parameter value) in a list; an empty list if there is none."""
    top = highest(stretches(graph, measure))
    return [] if top is None else [(top.response, top.value)]


def peak(found: Findings) -> dict[str, float]:
    """Return the largest response over all coexisting motions, and its parameter value."""
    name = default_measure(found.graph)
    responses = _highest(found.graph)
    responses += [(float(measures.get(name, np.nan)), value) for value, measures, _ in found.simulated]
    responses += [(float(motion.measures.get(name, np.nan)), motion.value) for motion in found.unbranched]
    value, place = max((pair for pair in responses if np.isfinite(pair[0])), default=(np.nan, np.nan))
    return {"peak": value, "peak_at": place}


def largest(found: Findings, measure: str) -> dict[str, float]:
    """Return the largest value of a measure over all coexisting stable motions, and its parameter value; nan if a simulated motion lacks the measure."""
    responses = _highest(found.graph, measure)
    others = [(measures.get(measure, np.nan), value) for value, measures in _without_branch(found)]
    if any(np.isnan(value) for value, _ in others):
        responses = []
    value, place = max(
        (pair for pair in responses + others if np.isfinite(pair[0])), default=(np.nan, np.nan)
    )
    return {f"largest_{measure}": value, f"largest_{measure}_at": place}


def lower_peak(found: Findings) -> dict[str, float]:
    """Return the largest response if at each value the lowest coexisting response occurs, and its parameter value.

    Simulated responses count only where no branch is stable.
    """
    name = default_measure(found.graph)
    grid, table = _compared(found.graph)
    finite = np.any(np.isfinite(table), axis=0)
    lowest = (
        list(zip(np.nanmin(table[:, finite], axis=0).tolist(), grid[finite].tolist())) if finite.any() else []
    )
    lowest_alone: dict[float, float] = {}
    for value, measures in _without_branch(found):
        lowest_alone[value] = min(lowest_alone.get(value, np.inf), float(measures.get(name, np.inf)))
    lowest += [(response, value) for value, response in lowest_alone.items() if np.isfinite(response)]
    top, place = max(lowest, default=(np.nan, np.nan))
    return {"lower_peak": top, "lower_peak_at": place}


def _without_branch(found: Findings, simulated: bool = True) -> list[tuple[float, Mapping[str, float]]]:
    """Return (value, measures) of motions without a branch in the gaps of the diagram; with `simulated`, of simulated motions, too."""
    responses = [(motion.value, motion.measures) for motion in found.unbranched]
    if simulated:
        responses += [(value, measures) for value, measures, _ in found.simulated]
    open_ = gaps(found.graph)
    return [(value, measures) for value, measures in responses if any(a < value < b for a, b in open_)]


def covered(found: Findings) -> dict[str, float]:
    """Return the share of the interval in which a stable response is known, from a branch or by simulation; nan if stability is not computed."""
    if not _has_stability(found.graph):
        return {"covered": np.nan}
    low, high = found.graph.within
    return {"covered": 1.0 - sum(b - a for a, b in _unknown_parts(found)) / (high - low)}


def _unknown_parts(found: Findings) -> list[tuple[float, float]]:
    """Return the intervals in which no stable response is known, neither from a branch nor by simulation."""
    name = default_measure(found.graph)
    values = [value for value, measures in _without_branch(found) if np.isfinite(measures.get(name, np.nan))]
    return not_simulated(gaps(found.graph), found.graph.within, values)


def unknown(found: Findings) -> str:
    """Describe the gaps in the known responses of a system.

    The text is empty if stable motions cover the interval and simulation found no motion without a branch, and if stability is not computed.
    """
    graph = found.graph
    if not _has_stability(graph):
        return ""
    name, unit = graph.parameter, graph.units.get(graph.parameter, "")
    reasons, number = [], figures_in(graph.within)
    open_ = _unknown_parts(found)
    if open_:
        low, high = max(open_, key=lambda gap: gap[1] - gap[0])
        part = sum(b - a for a, b in open_) / (graph.within[1] - graph.within[0])
        reasons.append(
            f"no stable motion is known in {100.0 * part:.3g} % of the interval, most of it {name} = {number(low)} to {number(high)}"
            f" {unit}".rstrip()
        )
    kinds = dict.fromkeys(motion.kind for motion in found.unbranched)
    for kind in kinds:
        values = sorted({motion.value for motion in found.unbranched if motion.kind == kind})
        count = len(values) - 1
        more = f" and {count} more value{'s' * (count > 1)}" if count else ""
        reasons.append(
            f"a motion without a branch ({kind}) is met at {name} = {number(values[0])} {unit}".rstrip()
            + more
        )
    if not kinds.keys().isdisjoint(UNBRANCHED):
        reasons.append("the largest response of such a motion is that of a finite run, and may be larger")
    if not graph.complete:
        reasons.append(str(graph.message))
    return "; ".join(reasons)


def _has_stability(graph: Graph) -> bool:
    """Whether the stability of any solution is computed."""
    return any(stable is not None for branch in graph.branches.values() for _, _, stable in branch.pieces())


def modulated(found: Findings) -> dict[str, float]:
    """Return the outcomes of modulated responses: simulated motions that do not recur, where no periodic motion is stable.

    Returns
    -------
    dict
        ``modulated``: share of the interval; lowest, mean and highest of the largest displacement per forcing period, for the motion with
        the largest mean; ``modulated_strong``: share of these motions whose impacts stop and begin again (strong modulation).
    """
    low, high = found.graph.within
    measured = [one.measures for one in found.unbranched if np.isfinite(one.measures.get(BAND[1], np.nan))]
    if not measured:
        return {"modulated": 0.0, **dict.fromkeys((*BAND, "modulated_strong"), np.nan)}
    covered = sum(b - a for a, b in gaps(found.graph)) - sum(b - a for a, b in _unknown_parts(found))
    top = max(measured, key=lambda measures: measures[BAND[1]])
    strong = [is_strong(measures) for measures in measured]
    return {
        "modulated": covered / (high - low),
        **{name: top[name] for name in BAND},
        "modulated_strong": float(np.mean(strong)),
    }


def activation(found: Findings) -> dict[str, float]:
    """Return the parameter values at which impacts begin.

    ``activation_from_below``: the largest value with a stable motion without impacts. ``activation_from_above``: the smallest value with
    a stable motion with impacts. Both are special points of the diagram. They are nan if the interval ends first, if a simulation
    contradicts them, and (from above) if the diagram has no motion without impacts: the branch that begins with impacts may then be missing.
    """
    low, high = found.graph.within
    parts = stretches(found.graph)
    calm = [s for s in parts if not s.branch.description.get("impacts")]
    busy = [s for s in parts if s.branch.description.get("impacts")]
    above = max((float(s.values.max()) for s in calm), default=np.nan)
    below = min((float(s.values.min()) for s in busy), default=np.nan)
    simulated = [(value, measures) for value, measures, _ in found.simulated]
    # outside of gaps, a motion without a branch coexists with stable branches and contradicts nothing
    simulated += _without_branch(found, simulated=False)
    impacting = [(value, m["impacts_per_period"]) for value, m in simulated if "impacts_per_period" in m]
    beyond = any(not impacts and value > above for value, impacts in impacting)
    before = any(impacts and value < below for value, impacts in impacting)
    return {
        "activation_from_below": above if above < high and not beyond else np.nan,
        "activation_from_above": below if below > low and calm and not before else np.nan,
    }


def stable_range(found: Findings, word: str) -> dict[str, float]:
    """Return the total length of the intervals in which a motion with this word is stable and real, their lower and their upper end."""
    parts = [
        interval
        for branch in found.graph.branches.values()
        if branch.real and branch.description.get("word") == word
        for interval in branch.stable_intervals()
    ]
    ends = (min(a for a, _ in parts), max(b for _, b in parts)) if parts else (np.nan, np.nan)
    length = sum(b - a for a, b in united(parts))
    return {f"stable_{word}": length, f"stable_{word}_from": ends[0], f"stable_{word}_to": ends[1]}


def first_point(found: Findings, kind: str) -> dict[str, float]:
    """Return the smallest parameter value of the real special points of a kind; nan if there is none."""
    values = [float(point.value) for point in found.graph.of_kind(kind) if point.real]
    return {f"first_{kind}": min(values, default=np.nan)}


def _compared(graph: Graph) -> tuple[np.ndarray, np.ndarray]:
    """Return a grid of values, shape (n,), and the responses of all stable stretches there, shape (m, n); nan outside of a stretch."""
    grid = np.linspace(graph.within[0], graph.within[1], GRID)
    rows = []
    for stretch in stretches(graph):
        order = np.argsort(stretch.values, kind="stable")
        rows.append(
            np.interp(grid, stretch.values[order], stretch.response[order], left=np.nan, right=np.nan)
        )
    return grid, np.array(rows).reshape(len(rows), GRID)


def coexisting(found: Findings) -> dict[str, float]:
    """Return the largest number of stable responses at one value, and the share of the interval with more than one."""
    count = np.isfinite(_compared(found.graph)[1]).sum(axis=0)
    return {
        "coexisting": float(count.max(initial=0)),
        "ambiguous": float(np.mean(count > 1)) if count.size else np.nan,
    }


def share(found: Findings, word: str) -> dict[str, float]:
    """Return the share of the simulated starts that settle on the motion with this word.

    For an atlas: the mean and the smallest of the shares at the values with the most starts. Otherwise: the share among all simulated motions.
    """
    attractors = found.graph.attractors
    if attractors:
        most = max(attractor.starts for attractor in attractors)
        by_value: dict[float, float] = {}
        for attractor in attractors:
            if attractor.starts == most:
                on_word = attractor.share if attractor.word == word else 0.0
                by_value[attractor.value] = by_value.get(attractor.value, 0.0) + on_word
        shares = list(by_value.values())
        return {f"share_{word}": float(np.mean(shares)), f"share_{word}_least": min(shares)}
    words = [name for _, _, name in found.simulated]
    return {f"share_{word}": words.count(word) / len(words) if words else np.nan}


PLAIN: dict[str, Outcome] = {
    "peak": peak,
    "lower_peak": lower_peak,
    "covered": covered,
    "activation": activation,
    "coexisting": coexisting,
    "modulated": modulated,
}
"""Outcomes by name."""
WITH_ARGUMENT: dict[str, Callable[..., Mapping[str, float]]] = {
    "stable": stable_range,
    "first": first_point,
    "share": share,
    "largest": largest,
}
"""Outcomes with an argument (word, kind or measure), written ``stable:LR``, ``first:period-doubling``, ``largest:impulse``."""
ARGUMENTS = {"stable": "word", "first": "kind", "share": "word", "largest": "measure"}
"""Name of the argument after the colon, by outcome."""
OF_ALL = frozenset(
    ("peak", "peak_at", "lower_peak", "lower_peak_at", "coexisting", "ambiguous", "impact_power", "friction_power", "pumping_time",
     "pumped_share")
)  # fmt: skip
"""Columns, also those of machines, about all motions together: they are only bounds if some motions are not known."""
