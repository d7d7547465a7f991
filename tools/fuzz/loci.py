"""Compare loci of random machines with diagrams: ``python -m tools.fuzz.loci KIND COUNT SALT [--first SEED]``.

At some points of a locus a diagram begins with the orbit of the locus; it must contain the special point at the same value of the parameter.
"""

from __future__ import annotations

import argparse
from collections import Counter
from typing import Any

import numpy as np

import contvines as cv
from tools.fuzz.drawing import KINDS, draw

RANGES = {
    "restitution": (0.05, 0.95),
    "friction": (0.0, 1.0),
    "gravity": (0.02, 1.0),
    "frequency": (0.6, 1.6),
    "damping": (0.1, 3.0),
    "forcing": (0.3, 6.0),
}
"""Second parameter -> its possible range."""
REACH = 0.2  # largest relative change of the second parameter
BORDERS = (
    "wall-graze",
    "velocity-graze",
    "stick",
    "vanishing-event",
)  # a border may have a different kind from its other side
FOLLOWED = ("fold", "branch-point", "period-doubling", "symmetry-breaking", "neimark-sacker", *BORDERS)
POINTS, PLACES = 3, 2  # special points per diagram, and points per locus that are checked
WIDTH = 0.05  # width of the interval of a diagram, relative to its middle
AGREE = 1e-6  # largest difference of parameter values


def second_parameter(
    orbit: Any, over: str, rng: np.random.Generator
) -> tuple[str, tuple[float, float]] | None:
    """Choose a second parameter and its interval; None if no parameter can vary."""
    known = orbit.parameters
    names = [name for name in RANGES if name != over and known.get(name, 0.0) != 0.0]
    if not names:
        return None
    name = str(rng.choice(names))
    value, (least, most) = known[name], RANGES[name]
    low, high = max(least, (1.0 - REACH) * value), min(most, (1.0 + REACH) * value)
    return (name, (low, high)) if low < value < high else None


def judge(kind: str, salt: int, seed: int, done: Counter[str]) -> list[str]:
    """Check the machine of a seed; return findings, and count the checks in `done`."""
    drawn, found = draw(kind, salt, seed), []
    if drawn.orbit is None:
        return []
    rng, over = np.random.default_rng([salt, seed]), drawn.options["over"]
    graph = cv.diagram(drawn.orbit, **drawn.options)
    points = [point for point in graph.special.values() if point.kind in FOLLOWED]
    rng.shuffle(points)
    for point in points[:POINTS]:
        second = second_parameter(point.orbit, over, rng)
        if second is None:
            continue
        where = f"{kind} {seed} (salt {salt}) {point.label} {point.kind} over {second[0]}"
        try:
            locus = cv.locus(point, over=second[0], within=second[1])
        except ValueError as error:
            print(
                f"{where}: {error}", flush=True
            )  # degenerate points, at which the equations of a locus are singular
            done["not started"] += 1
            continue
        done["loci"] += 1
        inner = len(locus) - 2  # leave out the ends, where a border, for example, may hide other points
        for i in (
            (1 + rng.choice(inner, size=min(PLACES, inner), replace=False)).tolist() if inner > 0 else ()
        ):
            value, other = map(float, locus.values[i])
            done["places"] += 1
            width = WIDTH * max(abs(value), 0.2)
            again = cv.diagram(
                locus.orbit(i), over=over, within=(value - width, value + width), depth=0, virtual=True
            )
            kinds = BORDERS if point.kind in BORDERS else (point.kind,)
            off = [abs(p.value - value) for p in again.special.values() if p.kind in kinds]
            if min(off, default=np.inf) > AGREE:
                found.append(f"{where}: nothing at {value:.12g}, {other:.12g} (place {i} of {len(locus)})")
    return found


def main() -> int:
    """Check all machines; return 1 if there are findings."""
    parser = argparse.ArgumentParser(prog="python -m tools.fuzz.loci", description="Search for false loci.")
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("count", type=int, help="machines")
    parser.add_argument("salt", type=int, help="another salt draws other machines")
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    asked = parser.parse_args()
    done, findings = Counter[str](), 0
    for seed in range(asked.first, asked.first + asked.count):
        for finding in judge(asked.kind, asked.salt, seed, done):
            findings += 1
            print(finding, flush=True)
    print(
        f"{done['loci']} loci, {done['not started']} not started, {done['places']} places, {findings} findings"
    )
    return 1 if findings else 0


if __name__ == "__main__":
    raise SystemExit(main())
