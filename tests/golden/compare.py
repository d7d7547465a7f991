"""Differences between a golden file and what is computed today, as sentences; none where they agree.

Values agree to 1e-10 of their size or to the stated location errors. Labels may change only among points of one kind that lie
nearer than 1e-8 to each other.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from contvines.bifurcation.kinds import BORDERS, RENAMED

VALUE = 1e-10
ENDS = 1e-8  # of branches and of stable stretches: borders of both kinds are located from either side
LOCI = 1e-6  # ends of loci where they run into a point of codimension two: the equations of a locus are singular there
NEAR = 1e-8
MULTIPLIERS = 1e-5  # at a fold they move with the square root of the location error


def differences(golden: dict[str, Any], today: dict[str, Any]) -> list[str]:
    """Sentences on all that differs between two graphs, or two charts, in the form of `compact`."""
    golden = with_names_of_today(golden)
    found = list(_points(golden["points"], today["points"]))
    if "loci" in golden:
        return found + list(_loci(golden["loci"], today["loci"]))
    renamed = _renamed(golden["points"], today["points"])
    found += _branches(golden["branches"], today["branches"])
    links = sorted([renamed.get(point, point), *ends] for point, *ends in golden["links"])
    found += [f"the link {link} is missing" for link in links if link not in today["links"]]
    found += [f"the link {link} is new" for link in today["links"] if link not in links]
    if golden["attractors"] != today["attractors"]:
        found.append(f"attractors {golden['attractors']} became {today['attractors']}")
    return found


def with_names_of_today(golden: dict[str, Any]) -> dict[str, Any]:
    """Borders at which an event vanishes were "chatter", labelled CH, when the files were written; see changes.md."""
    points = golden["points"]
    labels = {label: f"VE{label[2:]}" for label, point in points.items() if point["kind"] in RENAMED}
    if not labels:
        return golden
    renamed = {
        labels.get(label, label): point | {"kind": RENAMED.get(point["kind"], point["kind"])}
        for label, point in points.items()
    }
    links = [[labels.get(point, point), *ends] for point, *ends in golden["links"]]
    return golden | {"points": renamed, "links": links}


def _size(value: Any) -> float:
    return 1.0 + float(np.abs(value).max())


def _gap(one: dict[str, Any], other: dict[str, Any]) -> float:
    return float(np.abs(np.subtract(one["value"], other["value"])).max()) / _size(one["value"])


def _renamed(golden: dict[str, Any], today: dict[str, Any]) -> dict[str, str]:
    """Label today of each golden point: its own, or that of another point of its kind which is as near as allowed."""
    found: dict[str, str] = {}
    for label, point in golden.items():
        close = {
            other: _gap(point, entry) for other, entry in today.items() if entry["kind"] == point["kind"]
        }
        near = [other for other, gap in close.items() if gap < NEAR and other not in found.values()]
        if label in near:
            found[label] = label
        elif near:
            found[label] = min(near, key=lambda other: close[other])
    return found


def _points(golden: dict[str, Any], today: dict[str, Any]) -> Iterator[str]:
    renamed = _renamed(golden, today)
    for label, point in golden.items():
        if label not in renamed:
            yield f"{label} ({point['kind']} at {point['value']}) is missing"
            continue
        now = today[renamed[label]]
        if renamed[label] != label and not any(
            other is not point and other["kind"] == point["kind"] and _gap(point, other) < NEAR
            for other in golden.values()
        ):
            yield f"{label} is called {renamed[label]}"
        allowed = max(VALUE, (point["error"] + now["error"]) / _size(point["value"]))
        if _gap(point, now) > allowed:
            yield f"{label} moved from {point['value']} to {now['value']}"
        for name in ("real", "criticality", "branch", "on"):
            if name in point and point[name] != now[name]:
                yield f"{label}: {name} was {point[name]} and is {now[name]}"
        if "multipliers" in point and point["kind"] not in BORDERS and not _alike(point, now):
            yield f"{label}: moduli of multipliers were {point['multipliers']} and are {now['multipliers']}"
    for label in set(today) - set(renamed.values()):
        yield f"{label} ({today[label]['kind']} at {today[label]['value']}) is new"


def _alike(one: dict[str, Any], other: dict[str, Any]) -> bool:
    a, b = np.array(one["multipliers"]), np.array(other["multipliers"])
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=MULTIPLIERS, atol=MULTIPLIERS, equal_nan=True))


def _branches(golden: dict[str, Any], today: dict[str, Any]) -> Iterator[str]:
    for label, branch in golden.items():
        if label not in today:
            yield f"branch {label} ({branch['word']} k={branch['periods']}) is missing"
            continue
        now = today[label]
        for name in ("word", "periods", "symmetric", "real", "closed"):
            if branch[name] != now[name]:
                yield f"{label}: {name} was {branch[name]} and is {now[name]}"
        for name in ("range", "stable"):
            if not _same_intervals(branch[name], now[name]):
                yield f"{label}: {name} was {branch[name]} and is {now[name]}"
    for label in set(today) - set(golden):
        yield f"branch {label} ({today[label]['word']} k={today[label]['periods']}) is new"


def _same_intervals(one: Any, other: Any, ends: float = ENDS) -> bool:
    if one is None or other is None:
        return one is other
    a, b = np.array(sorted(one), dtype=float), np.array(sorted(other), dtype=float)
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=ends, atol=ends))


def _loci(golden: dict[str, Any], today: dict[str, Any]) -> Iterator[str]:
    for label, locus in golden.items():
        if label not in today:
            yield f"locus {label} ({locus['kind']} from {locus['seed']}) is missing"
            continue
        now = today[label]
        for name in ("kind", "seed", "closed"):
            if locus[name] != now[name]:
                yield f"{label}: {name} was {locus[name]} and is {now[name]}"
        if not _same_intervals(locus["ends"], now["ends"], LOCI):
            yield f"{label}: its ends were {locus['ends']} and are {now['ends']}"
    for label in set(today) - set(golden):
        yield f"locus {label} ({today[label]['kind']} from {today[label]['seed']}) is new"
