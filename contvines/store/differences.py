"""Differences between two graphs, or two charts, computed from the same study: moved, missing and new objects.

Values must agree to 1e-10 of their size or to the stated location errors. Labels may be exchanged only between points of one kind that
are less than 1e-8 apart.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kinds import BORDERS, RENAMED

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..graph import Graph
    from ..loci.chart import Chart


Stretches = list[tuple[float, float]] | None


def differences(before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """Return the differences between two results.

    Parameters
    ----------
    before, after : dict
        The earlier and the later result, both from `of_graph` or both from `of_chart`.

    Returns
    -------
    list of str
        A sentence for each difference; empty if they agree.
    """
    before = _with_names_of_today(before)
    found = list(_points(before["points"], after["points"]))
    if "loci" in before:
        return found + list(_loci(before["loci"], after["loci"]))
    renamed = _renamed(before["points"], after["points"])
    found += _branches(before["branches"], after["branches"])
    links = sorted([renamed.get(point, point), *ends] for point, *ends in before["links"])
    found += [f"the link {link} is missing" for link in links if link not in after["links"]]
    found += [f"the link {link} is new" for link in after["links"] if link not in links]
    if before["attractors"] != after["attractors"]:
        found.append(f"attractors {before['attractors']} became {after['attractors']}")
    return found


def _with_names_of_today(before: dict[str, Any]) -> dict[str, Any]:
    """Rename kinds and labels of earlier files: borders at which an event vanishes were called "chatter" and labelled CH."""
    points = before["points"]
    labels = {label: f"VE{label[2:]}" for label, point in points.items() if point["kind"] in RENAMED}
    if not labels:
        return before
    renamed = {
        labels.get(label, label): point | {"kind": RENAMED.get(point["kind"], point["kind"])}
        for label, point in points.items()
    }
    links = [[labels.get(point, point), *ends] for point, *ends in before["links"]]
    return before | {"points": renamed, "links": links}


def _size(value: ArrayLike) -> float:
    return 1.0 + float(np.abs(value).max())


def _gap(one: dict[str, Any], other: dict[str, Any]) -> float:
    return float(np.abs(np.subtract(one["value"], other["value"])).max()) / _size(one["value"])


def _renamed(before: dict[str, Any], after: dict[str, Any]) -> dict[str, str]:
    """Return the label in the later result of each point of the earlier one.

    It is the point's own label, or that of another point of its kind closer than `Agreement.end`. Missing points are left out.
    """
    found: dict[str, str] = {}
    for label, point in before.items():
        close = {
            other: _gap(point, entry) for other, entry in after.items() if entry["kind"] == point["kind"]
        }
        near = [other for other, gap in close.items() if gap < AGREEMENT.end and other not in found.values()]
        if label in near:
            found[label] = label
        elif near:
            found[label] = min(near, key=lambda other: close[other])
    for label, point in before.items():  # points that moved further but have the same label and kind
        if (
            label not in found
            and label not in found.values()
            and label in after
            and after[label]["kind"] == point["kind"]
        ):
            found[label] = label
    return found


def _points(before: dict[str, Any], after: dict[str, Any]) -> Iterator[str]:
    renamed = _renamed(before, after)
    for label, point in before.items():
        if label not in renamed:
            yield f"{label} ({point['kind']} at {point['value']}) is missing"
            continue
        later = after[renamed[label]]
        if renamed[label] != label and not any(
            other is not point and other["kind"] == point["kind"] and _gap(point, other) < AGREEMENT.end
            for other in before.values()
        ):
            yield f"{label} is called {renamed[label]}"
        allowed = max(AGREEMENT.value, (point["error"] + later["error"]) / _size(point["value"]))
        if _gap(point, later) > allowed:
            yield f"{label} moved from {point['value']} to {later['value']}"
        for name in ("real", "criticality", "branch", "on"):
            if name in point and point[name] != later[name]:
                yield f"{label}: {name} was {point[name]} and is {later[name]}"
        if "multipliers" in point and point["kind"] not in BORDERS and not _alike(point, later):
            yield f"{label}: moduli of multipliers were {point['multipliers']} and are {later['multipliers']}"
    for label in set(after) - set(renamed.values()):
        yield f"{label} ({after[label]['kind']} at {after[label]['value']}) is new"


def _alike(one: dict[str, Any], other: dict[str, Any]) -> bool:
    a, b = np.array(one["multipliers"]), np.array(other["multipliers"])
    return a.shape == b.shape and bool(
        np.allclose(a, b, rtol=AGREEMENT.multiplier, atol=AGREEMENT.multiplier, equal_nan=True)
    )


def _branches(before: dict[str, Any], after: dict[str, Any]) -> Iterator[str]:
    names, intervals = (
        ("word", "periods", "symmetric", "real", "closed"),
        {"range": "range was", "stable": "stable was"},
    )
    return _entries(before, after, "branch {} ({word} k={periods})", names, intervals)


def _loci(before: dict[str, Any], after: dict[str, Any]) -> Iterator[str]:
    return _entries(
        before, after, "locus {} ({kind} from {seed})", ("kind", "seed", "closed"), {"ends": "its ends were"}
    )


def _entries(
    before: dict[str, Any],
    after: dict[str, Any],
    called: str,
    names: Sequence[str],
    intervals: Mapping[str, str],
) -> Iterator[str]:
    """Yield the differences between curves (branches or loci).

    Parameters
    ----------
    before, after : dict
        Curves by label.
    called : str
        Format of a curve's name.
    names : sequence of str
        Fields that must be equal.
    intervals : mapping
        Field with intervals -> beginning of the sentence about its difference.
    """
    for label, entry in before.items():
        if label not in after:
            yield f"{called.format(label, **entry)} is missing"
            continue
        later = after[label]
        for name in names:
            if entry[name] != later[name]:
                yield f"{label}: {name} was {entry[name]} and is {later[name]}"
        for name, sentence in intervals.items():
            if not _same_intervals(entry[name], later[name]):
                yield f"{label}: {sentence} {entry[name]} and {'are' if sentence.endswith('were') else 'is'} {later[name]}"
    for label in set(after) - set(before):
        yield f"{called.format(label, **after[label])} is new"


def _same_intervals(one: Stretches, other: Stretches) -> bool:
    if one is None or other is None:
        return one is other
    a, b = np.array(sorted(one), dtype=float), np.array(sorted(other), dtype=float)
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=AGREEMENT.end, atol=AGREEMENT.end))


def of_graph(graph: Graph) -> dict[str, Any]:
    """Return branches, special points and links of a graph for `differences`, from its documented JSON."""
    data = graph.to_dict()
    names = ("word", "periods", "symmetric", "real", "range", "stable", "closed")
    return {
        "branches": {entry["label"]: {name: entry[name] for name in names} for entry in data["branches"]},
        "points": {
            entry["label"]: {
                "kind": entry["kind"],
                "branch": entry["branch"],
                "value": next(iter(entry["value"].values())),
                "error": entry["location_error"],
                "real": entry["real"],
                "criticality": entry["criticality"],
                "multipliers": _moduli(entry["multipliers"]),
            }
            for entry in data["special"]
        },
        "links": sorted([link["point"], link["from"], link["to"]] for link in data["switches"]),
        "attractors": sorted(
            [entry["word"], entry["periods"]] for entry in data.get("attractors", []) if "word" in entry
        ),
    }


def of_chart(chart: Chart) -> dict[str, Any]:
    """Return loci with their ends and codimension-two points of a chart for `differences`, from its documented JSON."""
    data = chart.to_dict()
    return {
        "loci": {
            entry["label"]: {
                "kind": entry["kind"],
                "seed": entry["seed"],
                "closed": entry["closed"],
                "ends": [] if entry["closed"] else sorted([entry["values"][0], entry["values"][-1]]),
            }
            for entry in data["loci"]
        },
        "points": {
            entry["label"]: {
                "kind": entry["kind"],
                "value": [float(value) for value in entry["value"].values()],
                "error": entry["error"],
                "real": entry["real"],
                "on": sorted(entry["on"]),
            }
            for entry in data["points"]
        },
    }


def _moduli(pairs: list[list[float]]) -> list[float]:
    return sorted(float(np.hypot(real, imag)) for real, imag in pairs)


@dataclass(frozen=True)
class Agreement:
    """Tolerances within which two results agree, relative to 1 + the size of the numbers.

    Attributes
    ----------
    value : float
        For values of special points, unless a larger location error is stated.
    end : float
        For the ends of branches, loci and stable stretches (borders are located from either side); also the distance below which
        points of one kind may exchange labels.
    multiplier : float
        For multipliers; at a fold they vary with the square root of the location error.
    """

    value: float = 1e-10
    end: float = 1e-8
    multiplier: float = 1e-5


AGREEMENT = Agreement()
