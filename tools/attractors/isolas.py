"""Twenty-five isolas (branches that are connected to no other one): `python -m tools.attractors.isolas` searches for all of them."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

import contvines as cv
from orbits import Absorber, Coupled
from orbits.machines.physical import physical

SINGLE = partial(Absorber, restitution=0.76, gravity=0.211, mass_ratio=0.006)


@dataclass(frozen=True)
class Isola:
    """An isola that is known independently, by its folds or by a value at which it is stable.

    Attributes
    ----------
    name : str
    atlas : callable
        Computes the graph that must contain it.
    folds : tuple of float
        Values of its folds, from a closed form or an independent solution.
    tolerance : float
        Largest error of the folds.
    attracts : (float, int, int) or None
        A value at which it is stable, its periods and its impacts.
    quick : bool
        Whether the atlas takes about a second.
    """

    name: str
    atlas: Callable[[], cv.Graph]
    folds: tuple[float, ...] = ()
    tolerance: float = 1e-8
    attracts: tuple[float, int, int] | None = None
    quick: bool = False

    def found(self, graph: cv.Graph) -> bool:
        """Whether the graph contains the isola."""
        folds = np.array([point.value for point in graph.of_kind("fold")])
        if not all(np.abs(folds - fold).min(initial=np.inf) < self.tolerance for fold in self.folds):
            return False
        if self.attracts is None:
            return True
        at, periods, impacts = self.attracts
        return any(
            branch.real
            and branch.description.get("periods") == periods
            and sum(letter in "LR" for letter in str(branch.description["word"])) == impacts
            and any(low <= at <= high for low, high in branch.stable_intervals())
            for branch in graph
        )


def pitchfork(tilt: float) -> Isola:
    """Map x -> x + (p x - x^3 + tilt) / 5: the lower pair has a fold at p = 3 (tilt / 2)^(2/3) and is not connected to the upper branch."""

    def step(x: Any, p: float) -> Any:
        return x + (p * x - x**3 + tilt) / 5.0

    def atlas() -> cv.Graph:
        population = cv.MapProblem(step, [1.0], 0.5).population(box=[(-1.5, 1.5)])
        return cv.atlas(population, within=(-0.5, 1.0), values=6, starts=32, depth=0)

    return Isola(f"pitchfork, tilt {tilt:g}", atlas, (3.0 * (tilt / 2.0) ** (2.0 / 3.0),), quick=True)


def circle(radius: float) -> Isola:
    """A closed branch between p = 0.37 -+ radius: y^2 + ((p - 0.37) / radius)^2 = 1, y = (x - 1) / 0.3."""

    def step(x: Any, p: float) -> Any:
        return x + 0.1 * (1.0 - ((p - 0.37) / radius) ** 2 - ((x - 1.0) / 0.3) ** 2)

    def atlas() -> cv.Graph:
        population = cv.MapProblem(step, [1.0], 0.37).population(box=[(0.5, 1.5)])
        return cv.atlas(
            population, within=(0.0, 1.0), values=8, starts=32, depth=0, scan=int(1.0 / radius) + 1
        )

    return Isola(f"circle of radius {radius:g}", atlas, (0.37 - radius, 0.37 + radius), quick=radius > 0.01)


def window(period: int, near: float, point: float) -> Isola:
    """A window of the logistic map: the cycle has a fold where f^n(x) = x and (f^n)'(x) = 1, solved here by Newton's method."""
    x, p = point, near
    for _ in range(50):
        rest, matrix = _tangency(period, x, p)
        x, p = np.array([x, p]) - np.linalg.solve(matrix, rest)

    def atlas() -> cv.Graph:
        population = cv.MapProblem(lambda x, p: p * x * (1 - x), [0.6], 3.5).population(box=[(0.01, 0.99)])
        wide = 0.03 * 4.0 ** (3 - period)
        return cv.atlas(population, within=(p - 4.0 * wide, p + 6.0 * wide), values=8, starts=32, depth=0)

    return Isola(f"window of period {period} at {p:.6f}", atlas, (float(p),))


def _tangency(period: int, x: float, p: float) -> tuple[np.ndarray, np.ndarray]:
    """Return f^n(x) - x and (f^n)'(x) - 1, and their derivatives by x and p, computed by second-order forward differentiation."""
    y, yx, yp, yxx, yxp = x, 1.0, 0.0, 0.0, 0.0
    for _ in range(period):
        d, dd = p * (1 - 2 * y), -2 * p
        yxx, yxp = dd * yx**2 + d * yxx, dd * yx * yp + d * yxp + (1 - 2 * y) * yx
        yp = d * yp + y * (1 - y)
        yx, y = d * yx, p * y * (1 - y)
    return np.array([y - x, yx - 1.0]), np.array([[yx - 1.0, yp], [yxx, yxp]])


def alone(
    word: str,
    friction: float,
    within: tuple[float, float],
    attracts: tuple[float, int, int],
    quick: bool = False,
) -> Isola:
    """A motion of the absorber that no diagram from `LR` contains; an independent simulation shows a value at which it is stable."""

    def atlas() -> cv.Graph:
        return cv.atlas(
            SINGLE(friction=friction), over="amplitude", within=within, values=6, starts=64, depth=0
        )

    return Isola(f"{word}, friction {friction:g}", atlas, attracts=attracts, quick=quick)


def island() -> Isola:
    """Asymmetric orbits of the coupled machine between 0.992992 and 0.998990, not connected to its frequency response."""
    coupled = Coupled(
        forcing=2.47, damping=1.0, mass_ratio=0.006, restitution=0.76, friction=0.5, gravity=0.211
    )

    def atlas() -> cv.Graph:
        return cv.atlas(coupled, over="frequency", within=(0.990, 1.001), values=12, starts=64, depth=0)

    return Isola("island of asymmetric orbits", atlas, (0.992992, 0.998990), tolerance=1e-6)


def wide(half_width: int) -> Isola:
    """The closed response of an absorber in a wide cavity, which is not connected to the sliding motion.

    Above 32.5 mm (at 8.054 Hz) it is unstable: a pair of multipliers lies outside the unit circle.
    """
    coupled = physical(
        "coupled",
        {
            "oscillator_mass": "3.8 kg",
            "natural_frequency": "8 Hz",
            "absorber_mass": "32 g",
            "half_width": f"{half_width} mm",
            "damping_ratio": 0.007,
            "restitution": 0.6,
            "friction": 0.1,
            "base_amplitude": "0.3 mm",
        },
    )

    def atlas() -> cv.Graph:
        return cv.atlas(coupled, over="frequency", within=(7.0, 9.0), values=8, starts=64, depth=0)

    return Isola(f"closed response, half-width {half_width} mm", atlas, attracts=(8.0, 1, 2))


ISOLAS: list[Isola] = [
    *[pitchfork(tilt) for tilt in (0.02, 0.05, 0.1, 0.2)],
    *[circle(radius) for radius in (0.2, 0.05, 0.02, 0.005)],
    window(3, 3.8284, 0.514),
    window(4, 3.9601, 0.505),
    window(5, 3.7382, 0.504),
    window(5, 3.9056, 0.502),
    window(6, 3.6266, 0.504),
    alone("LRLRLR", 0.5, (0.5, 0.75), (0.58, 3, 6)),
    alone("LRLt", 0.5, (0.9, 1.15), (1.1, 1, 3), quick=True),
    alone("LRLttRLRtt", 0.5, (0.7, 0.85), (0.78, 3, 6)),
    alone("LRLtLRLt", 0.5, (1.15, 1.25), (1.185, 2, 6)),
    alone("LRLttRLRtt", 0.05, (0.5, 0.65), (0.57, 3, 6)),
    alone("LRLtLRLttRLRtRLRtt", 0.05, (0.8, 0.92), (0.86, 5, 12)),
    alone("LRLt", 0.05, (0.9, 1.1), (1.0, 1, 3)),
    alone("LRLtLRLt", 0.05, (1.05, 1.2), (1.125, 2, 6)),
    island(),
    wide(27),
    wide(30),
    wide(31),
]


def main() -> None:
    """Print a line for each isola (or for the first N): found or missing, number of branches, processor time."""
    missing, wanted = 0, ISOLAS[: int(sys.argv[1])] if len(sys.argv) > 1 else ISOLAS
    for isola in wanted:
        begin = time.process_time()
        graph = isola.atlas()
        found = isola.found(graph)
        missing += not found
        seconds = time.process_time() - begin
        print(
            f"{'found' if found else 'MISSING':8} {len(graph.branches):4} branches {seconds:7.1f} s  {isola.name}",
            flush=True,
        )
    print(f"{len(wanted) - missing} of {len(wanted)} found")


if __name__ == "__main__":
    main()
