"""Stable manifolds of saddles on a plane section: the curves that separate basins.

They are grown without the inverse of the motion (England, Krauskopf and Osinga, SIAM J. Appl. Dyn. Syst. 3 (2004) 161): the next
point lies on a small circle round the last one, where its image falls on the part of the curve that is known already.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ..circles.section import section_of
from ..graph.graph import Graph
from .solutions import solutions_at

FIRST = 1e-4  # of the plane's size: distance of the first point from the saddle
LARGEST, SMALLEST = 0.01, 1e-6  # of the plane's size: radii of the circles
TURN, STRAIGHT = (
    0.3,
    0.05,
)  # angles between two steps beyond which the radius shrinks, and below which it grows
CORNER = 1e-3  # of the plane's size: radius below which the curve may have a corner, as where an impact begins to be missed
BENT = 2.6  # largest angle of a corner
ARCS = 12  # candidates on the part of a circle that is searched
REFINED = 40  # halvings of an angle
DIFFERENCE = 1e-6  # of the plane's size: for the derivative at the saddle
LENGTH = 20.0  # sizes of the plane: a curve ends when it is so long


@dataclass(frozen=True)
class Manifold:
    """One of the two halves of a saddle's stable manifold.

    Attributes
    ----------
    branch : str
        Of the saddle.
    word : str
    points : float array (n, 2)
        From the saddle outwards.
    ended : str
        ``leaves`` the plane, is ``long``, or ``breaks``: where the motion is not continuous the curve cannot be followed further.
    """

    branch: str
    word: str
    points: np.ndarray
    ended: str

    def to_dict(self) -> dict[str, Any]:
        """Ready for JSON."""
        return {
            "branch": self.branch,
            "word": self.word,
            "points": self.points.tolist(),
            "ended": self.ended,
        }


def stable_manifolds(
    graph: Graph, at: float, limits: np.ndarray, *, longest: float = LENGTH
) -> list[Manifold]:
    """Both halves of the stable manifolds of all real saddles, and their images, that a graph has at a value of its parameter.

    Parameters
    ----------
    graph : Graph
    at : float
    limits : float array (2, 2)
        Smallest and largest coordinates of the plane.
    longest : float
        Sizes of the plane.

    Returns
    -------
    list of Manifold
        None for saddles of motions with more than two states.
    """
    found: list[Manifold] = []
    for branch in graph.branches.values():
        if not branch.real or branch.problem is None:
            continue
        for u in _saddles(branch, at):
            section = section_of(branch.problem, at)
            if len(section.names) != 2:
                continue
            word = str(branch.description.get("word", branch.label))
            for place in _places(branch.problem, section, u):
                for points, ended in _halves(section.step, place, limits, longest):
                    found.append(Manifold(branch.label, word, points, ended))
    return found


def check_plane(graph: Graph, parameter: str, plane: tuple[str, str], others: Mapping[str, float]) -> None:
    """Refuse a plane that is not the section of the graph's motions.

    Raises
    ------
    ValueError
        Saying what would do.
    """
    if graph.parameter != parameter:
        raise ValueError(f"saddles: the graph's parameter is {graph.parameter}, not {parameter}")
    names: tuple[str, ...] = ()
    for branch in graph.branches.values():
        if (
            branch.problem is not None and branch.description.get("word") != ""
        ):  # what never slides has no section
            names = section_of(branch.problem, float(branch.values[0])).names
            break
    if not names:
        raise ValueError("saddles: the graph has no motions that can be simulated period by period")
    if len(names) != 2:
        raise ValueError(
            f"saddles: stable manifolds are curves only where motions have two states; here these are {', '.join(names)}"
        )
    if tuple(plane) != tuple(names) or any(others.values()):
        raise ValueError(f"saddles: choose the plane {names[0]}, {names[1]}, with all other coordinates zero")


def _places(problem: Any, section: Any, u: np.ndarray) -> list[np.ndarray]:
    """Where a solution and its images under the problem's symmetries meet the section, each point once."""
    found: list[np.ndarray] = []
    for one in (u, *(symmetry.apply(u) for symmetry in problem.symmetries)):
        for place in section.rounds(one):
            if not any(np.allclose(place, other, atol=1e-7) for other in found):
                found.append(place)
    return found


def _saddles(branch: Any, at: float) -> list[np.ndarray]:
    """Unknowns of the branch's real solutions at a value with one multiplier outside the circle."""
    engine, solved = solutions_at(branch, at)
    return [one.u for one in solved if np.count_nonzero(np.abs(engine.multipliers(one.row)) > 1.0) == 1]


def _halves(
    step: Callable[[np.ndarray], np.ndarray], place: np.ndarray, limits: np.ndarray, longest: float
) -> list[tuple[np.ndarray, str]]:
    size = float(np.ptp(limits, axis=1).max())
    jacobian = np.empty((2, 2))
    for j in range(2):
        moved = np.zeros(2)
        moved[j] = DIFFERENCE * size
        jacobian[:, j] = (step(place + moved) - step(place - moved)) / (2.0 * DIFFERENCE * size)
    if not np.all(np.isfinite(jacobian)):
        return []
    values: Any
    vectors: Any
    values, vectors = np.linalg.eig(jacobian)
    if np.abs(values.imag).max() > 0.0 or not np.abs(values).min() < 1.0 < np.abs(values).max():
        return []
    k = int(np.abs(values).argmin())
    twice = float(values.real[k]) < 0.0  # the two halves change places: every second image stays on one
    image = (lambda x: step(step(x))) if twice else step
    return [_grown(image, place, side * vectors.real[:, k], limits, size, longest) for side in (1.0, -1.0)]


def _grown(
    image: Callable[[np.ndarray], np.ndarray],
    place: np.ndarray,
    direction: np.ndarray,
    limits: np.ndarray,
    size: float,
    longest: float,
) -> tuple[np.ndarray, str]:
    points = [place, place + FIRST * size * direction / np.linalg.norm(direction)]
    radius, length, at = FIRST * size, FIRST * size, 0
    ended = "long"
    while length < longest * size:
        heading = points[-1] - points[-2]
        found = _next(image, points, heading, radius, at, TURN)
        if found is None and radius < CORNER * size:
            found = _next(image, points, heading, radius, at, BENT)
        if found is None:
            radius *= 0.5
            if radius < SMALLEST * size:
                edge = np.abs(points[-1][:, None] - limits).min() < CORNER * size  # no start beyond a wall
                ended = "leaves" if edge else "breaks"
                break
            continue
        point, at, turn = found
        points.append(point)
        length += radius
        if np.any(point < limits[:, 0]) or np.any(point > limits[:, 1]):
            ended = "leaves"
            break
        if turn < STRAIGHT:
            radius = min(2.0 * radius, LARGEST * size)
    return np.array(points), ended


def _next(
    image: Callable[[np.ndarray], np.ndarray],
    points: list[np.ndarray],
    heading: np.ndarray,
    radius: float,
    at: int,
    widest: float,
) -> tuple[np.ndarray, int, float] | None:
    """The point on the circle whose image lies on the curve, the segment on which it lies, and the angle turned by."""
    middle = np.arctan2(heading[1], heading[0])
    known = np.array(points)

    def offset(angle: float) -> tuple[float, int]:
        point = points[-1] + radius * np.array([np.cos(angle), np.sin(angle)])
        return _beside(known, image(point), at)

    count = int(np.ceil(ARCS * max(1.0, widest))) if widest > TURN else ARCS
    turns = [float(turn) for turn in widest * np.linspace(-1.0, 1.0, count + 1)]
    order = sorted(pairwise(turns), key=lambda ends: abs(ends[0] + ends[1]))
    sides: dict[float, tuple[float, int]] = {}
    for low, high in order:
        for turn in (low, high):
            if turn not in sides:
                sides[turn] = offset(middle + turn)
        (a, _), (b, _) = sides[low], sides[high]
        if not (np.isfinite(a) and np.isfinite(b)) or a * b > 0.0:
            continue
        segment = at
        for _ in range(REFINED):
            half = 0.5 * (low + high)
            value, segment = offset(middle + half)
            if not np.isfinite(value):
                return None
            if value * a > 0.0:
                low = half
            else:
                high = half
        if abs(value) > 1e-3 * radius:  # a jump of the motion, not a crossing of the curve
            continue
        angle = middle + 0.5 * (low + high)
        return (
            points[-1] + radius * np.array([np.cos(angle), np.sin(angle)]),
            segment,
            abs(0.5 * (low + high)),
        )
    return None


def _beside(known: np.ndarray, point: np.ndarray, at: int) -> tuple[float, int]:
    """Signed distance of a point to the known curve near its segment `at` or later ones, and the nearest segment."""
    if not np.all(np.isfinite(point)):
        return float("nan"), at
    first = max(at - 2, 0)
    starts, ends = known[first:-1], known[first + 1 :]
    along = ends - starts
    lengths = np.maximum((along * along).sum(axis=1), 1e-300)
    part = ((point - starts) * along).sum(axis=1) / lengths
    inside = np.clip(part, 0.0, 1.0)
    gaps = np.linalg.norm(point - (starts + inside[:, None] * along), axis=1)
    k = int(gaps.argmin())
    if k == len(gaps) - 1 and part[k] > 1.0:
        return float("nan"), at  # beyond what is known
    across = along[k, 0] * (point - starts[k])[1] - along[k, 1] * (point - starts[k])[0]
    return float(np.sign(across) * gaps[k]), first + k
