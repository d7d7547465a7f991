"""Stable manifolds of saddles on a plane section: the curves that separate basins.

The curves are grown without inverting the section map (England, Krauskopf and Osinga, SIAM J. Appl. Dyn. Syst. 3 (2004) 161): the next
point lies on a small circle around the last one, where its image falls on the known part of the curve. At a wall a curve continues at
the velocity after (or before) the impact, which belongs to the same motion.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import brentq

from ..bifurcation.scan import image_of
from ..branches.solutions import solutions_at
from ..circles.section import Section, Walled, section_of
from ..continuation.settings import Settings
from ..graph import Graph
from ..shared.numbers import TINY
from .settings import MANIFOLDS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..branches import Branch
    from ..problems.protocol import Problem


# largest error of the linear prediction of the first point's image, relative to the point's distance from the saddle; it is larger
# for a saddle beside a grazing impact, where a smaller distance is tried
LINEAR = 0.1
STRAIGHT = 0.05  # radians: angle between two steps below which the radius grows
BENT = 2.6  # radians: largest angle of a corner
INWARD = 1.55  # radians: largest angle to the inward normal at which a curve leaves a wall
PIECES = 40  # largest number of pieces of a curve between walls
DIFFERENCE = 0.01  # step of the differences at the saddle, relative to the first point's distance
LENGTH = 20.0  # largest length of a curve, relative to the plane's size
MOST = 1_200_000  # largest number of periods simulated for all curves


@dataclass(frozen=True)
class Manifold:
    """A piece of one of the two halves of a saddle's stable manifold.

    Attributes
    ----------
    branch : str
        Label of the saddle's branch.
    word : str
        Word of the saddle.
    points : float array (n, 2)
        From the saddle outwards, or from the wall at which the piece before it ends.
    ended : str
        How the piece ends:

        - ``leaves``: it leaves the plane;
        - ``wall``: it comes to a wall, and the next piece continues it;
        - ``long``: it is cut, because its length or the number of simulated periods is used up;
        - ``breaks``: it cannot be followed further, for example where the motion is discontinuous.
    """

    branch: str
    word: str
    points: np.ndarray
    ended: str

    def to_dict(self, sizes: ArrayLike = 1.0) -> dict[str, Any]:
        """Return the piece ready for JSON; `sizes` are the factors from computed to displayed coordinates."""
        return {
            "branch": self.branch,
            "word": self.word,
            "points": (self.points * sizes).tolist(),
            "ended": self.ended,
        }


def stable_manifolds(graph: Graph, at: float, limits: np.ndarray, *, most: int = MOST) -> list[Manifold]:
    """Compute both halves of the stable manifolds of all real saddles of a graph, and of their images under symmetries, at a parameter value.

    Parameters
    ----------
    graph : Graph
        With its problems attached.
    at : float
        Value of its parameter.
    limits : float array (2, 2)
        Lower and upper limit of each coordinate of the plane.
    most : int
        Largest number of periods simulated for all curves together, shared equally: with many saddles the curves are shorter.

    Returns
    -------
    list of Manifold
        Empty for saddles of motions with more than two states.
    """
    wanted: list[tuple[str, str, Section, np.ndarray, int]] = []
    same = Settings.kept(graph.settings).same
    for branch in graph.branches.values():
        if not branch.real or branch.problem is None:
            continue
        for u in _saddles(branch, at):
            section = section_of(branch.problem, at)
            if len(section.names) != 2:
                continue
            word = str(branch.description.get("word", branch.label))
            periods = len(section.rounds(u))
            wanted += [
                (branch.label, word, section, place, periods)
                for place in _places(branch.problem, section, u, at, same)
            ]
    wanted.sort(key=lambda entry: entry[-1])  # saddles of few periods first: they separate wide basins
    found: list[Manifold] = []
    for k, (label, word, section, place, periods) in enumerate(wanted):
        counted = _Counted(section.step, most // (len(wanted) - k) // periods)
        for points, ended in _halves(section, counted, place, limits):
            found.append(Manifold(label, word, points, ended))
        most -= counted.steps * periods
    return found


def check_plane(graph: Graph, parameter: str, plane: tuple[str, str], others: Mapping[str, float]) -> None:
    """Check that a plane is the section of a graph's motions.

    Parameters
    ----------
    graph : Graph
    parameter : str
        The parameter of the plane's machine.
    plane : (str, str)
        Names of the plane's coordinates.
    others : mapping
        Values of the other coordinates, which must be zero.

    Raises
    ------
    ValueError
        If it is not; the message suggests a remedy.
    """
    if graph.parameter != parameter:
        raise ValueError(f"saddles: the graph's parameter is {graph.parameter}, not {parameter}")
    names: tuple[str, ...] = ()
    for branch in graph.branches.values():
        if (
            branch.problem is not None and branch.description.get("word") != ""
        ):  # a motion without events has no section
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


class _Counted:
    """A section map that counts its evaluations, `steps`; `most` is their largest number, which the caller checks."""

    def __init__(self, step: Callable[[np.ndarray], np.ndarray], most: int) -> None:
        self.step, self.most, self.steps = step, most, 0

    def __call__(self, x: np.ndarray) -> np.ndarray:
        self.steps += 1
        return self.step(x)


def _places(problem: Problem, section: Section, u: np.ndarray, p: float, same: float) -> list[np.ndarray]:
    """Return the points at which a solution and its images under symmetries meet the section, each once; `same` is `Settings.same`."""
    found: list[np.ndarray] = []
    for one in (u, *(image_of(symmetry, u, p) for symmetry in problem.symmetries)):
        for place in section.rounds(one):
            if not any(np.allclose(place, other, rtol=same, atol=same) for other in found):
                found.append(place)
    return found


def _saddles(branch: Branch, at: float) -> list[np.ndarray]:
    """Return the unknowns of the branch's solutions at a value that have exactly one multiplier outside the unit circle."""
    engine, solved = solutions_at(branch, at)
    return [one.u for one in solved if np.count_nonzero(np.abs(engine.multipliers(one.row)) > 1.0) == 1]


def _halves(
    section: Section, step: _Counted, place: np.ndarray, limits: np.ndarray
) -> list[tuple[np.ndarray, str]]:
    """Return the pieces of both halves of the stable manifold of a saddle at `place`, and how each piece ends."""
    size = float(np.ptp(limits, axis=1).max())
    found = [
        saddle for first in MANIFOLDS.first if (saddle := _linear(step, place, first * size)) is not None
    ]
    if not found:
        return []
    first, ray, slow, _ = next((saddle for saddle in found if saddle[-1] < LINEAR), found[0])
    # with a negative multiplier the map exchanges the two halves, and its square keeps them
    image = (lambda x: step(step(x))) if slow < 0.0 else step
    struck = section.struck if isinstance(section, Walled) else None
    pieces = []
    for side, most in ((1.0, (step.most + step.steps) // 2), (-1.0, step.most)):
        half = _Half(image, struck, place, side * ray, first, limits)
        pieces += half.grown(lambda most=most: step.steps < most)
    return pieces


def _linear(
    step: Callable[[np.ndarray], np.ndarray], place: np.ndarray, first: float
) -> tuple[float, np.ndarray, float, float] | None:
    """Linearise the section map at a saddle by differences, with step `DIFFERENCE` times `first`.

    Parameters
    ----------
    step : callable
        The section map.
    place : float array (2,)
        The saddle.
    first : float
        Distance from the saddle of the first point on the manifold.

    Returns
    -------
    (first, ray, slow, off) or None
        The distance, the unit stable direction, the stable multiplier, and the error of the linear prediction of the first points' images,
        relative to `first`. None if the point is no saddle.
    """
    jacobian, step_size = np.empty((2, 2)), DIFFERENCE * first
    for j in range(2):
        shift = np.zeros(2)
        shift[j] = step_size
        jacobian[:, j] = (step(place + shift) - step(place - shift)) / (2.0 * step_size)
    if not np.all(np.isfinite(jacobian)):
        return None
    values, vectors = np.linalg.eig(jacobian)
    if np.abs(np.imag(values)).max() > 0.0 or not np.abs(values).min() < 1.0 < np.abs(values).max():
        return None
    k = int(np.abs(values).argmin())
    slow, ray = float(np.real(values[k])), np.real(vectors[:, k])
    ray = ray / np.linalg.norm(ray)
    images = [step(place + side * first * ray) - place - side * slow * first * ray for side in (1.0, -1.0)]
    error = max(float(np.linalg.norm(image)) for image in images) / first
    return first, ray, slow, error if np.isfinite(error) else np.inf


class _Half:
    """One half of a stable manifold while it grows, as a list of pieces between walls.

    Parameters
    ----------
    image : callable
        The section map, or its square.
    struck : callable or None
        ``struck(point, near)`` returns the point on the other side of an impact, if `point` lies at a wall; see `Walled`.
    place, ray : float array (2,)
        The saddle, and the stable direction of this half.
    first : float
        Distance of the first point from the saddle.
    limits : float array (2, 2)
        Of the plane.
    """

    def __init__(
        self,
        image: Callable[[np.ndarray], np.ndarray],
        struck: Callable[[np.ndarray, float], tuple[np.ndarray, np.ndarray] | None] | None,
        place: np.ndarray,
        ray: np.ndarray,
        first: float,
        limits: np.ndarray,
    ) -> None:
        self.image, self.struck, self.limits = image, struck, limits
        self.size = float(np.ptp(limits, axis=1).max())
        self.pieces = [[place, place + first * ray]]
        self.heading, self.at, self.length = ray, 0, first
        self.smallest = min(MANIFOLDS.smallest * self.size, 0.01 * first)

    def grown(self, more: Callable[[], bool]) -> list[tuple[np.ndarray, str]]:
        """Grow the curve while ``more()`` is true; return its pieces and how each ends."""
        self.more = more
        ends = [self._grow(self.length, TURN)]
        while ends[-1] == "leaves" and self._continue_behind():
            ended = self._grow(MANIFOLDS.corner * self.size, INWARD)
            if len(self.pieces[-1]) == 1:  # the curve does not leave the wall
                self.pieces.pop()
                break
            ends[-1] = "wall"
            ends.append("long" if len(ends) + 1 == PIECES else ended)
        return [(np.array(points), end) for points, end in zip(self.pieces, ends, strict=True)]

    def _grow(self, radius: float, widest: float) -> str:
        """Grow the last piece and return how it ends.

        Parameters
        ----------
        radius : float
            First radius of the circles.
        widest : float
            Largest angle to the heading of the first step.
        """
        points, size, limits = self.pieces[-1], self.size, self.limits
        while self.length < LENGTH * size and self.more():
            starts, ends = self._segments()
            curve = (starts, ends, self.at)
            found = next_point(self.image, curve, points[-1], self.heading, radius, widest)
            if found is None and widest == TURN and radius < MANIFOLDS.corner * size:
                found = next_point(self.image, curve, points[-1], self.heading, radius, BENT)
            if found is None:
                radius *= 0.5
                if radius < self.smallest:
                    # at the plane's edge or a wall, beyond which no start exists, the curve has left the plane
                    edge = np.abs(points[-1][:, None] - limits).min() < MANIFOLDS.corner * size
                    at_wall = len(points) > 1 and (edge or self._reflected() is not None)
                    return "leaves" if at_wall else "breaks"
                continue
            point, self.at, turn = found
            self.heading = point - points[-1]
            points.append(point)
            self.length += radius
            if np.any(point < limits[:, 0]) or np.any(point > limits[:, 1]):
                return "leaves"
            if turn < STRAIGHT or widest > TURN:
                radius = min(2.0 * radius, MANIFOLDS.largest * size)
            widest = TURN
        return "long"

    def _continue_behind(self) -> bool:
        """Begin another piece on the other side of an impact; return whether it lies within the plane."""
        found = self._reflected()
        if found is None or np.any(found[0] < self.limits[:, 0]) or np.any(found[0] > self.limits[:, 1]):
            return False
        self.pieces.append([found[0]])
        self.heading = found[1]
        return True

    def _reflected(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the point at which the curve continues if its last point is at a wall, and the direction away from the wall; otherwise None."""
        return None if self.struck is None else self.struck(self.pieces[-1][-1], MANIFOLDS.corner * self.size)

    def _segments(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the beginnings and the ends of the segments of all pieces, each of shape (n, 2)."""
        pieces = [np.array(points) for points in self.pieces]
        return np.concatenate([x[:-1] for x in pieces]), np.concatenate([x[1:] for x in pieces])


TURN = 0.3  # radians: angle between two steps beyond which the radius shrinks
ARCS = 12  # number of arcs into which the searched part of a circle is divided
REFINED = 60  # largest number of iterations for the angle


def next_point(
    image: Callable[[np.ndarray], np.ndarray],
    curve: tuple[np.ndarray, np.ndarray, int],
    last: np.ndarray,
    heading: np.ndarray,
    radius: float,
    widest: float,
) -> tuple[np.ndarray, int, float] | None:
    """Find the next point of a stable manifold: a point of a circle whose image lies on the known curve.

    Parameters
    ----------
    image : callable
        The section map.
    curve : (starts, ends, at)
        Segments of the known curve, and the number of the segment on which the last point's image lies.
    last, heading : float array (2,)
        The last point and the direction of the last step.
    radius : float
        Of the circle around the last point.
    widest : float
        Largest angle to the heading, in radians.

    Returns
    -------
    (point, segment, angle) or None
        The point, the segment on which its image lies, and the angle to the heading; None if there is none.
    """
    middle, near = np.arctan2(heading[1], heading[0]), MANIFOLDS.on_curve * radius
    sides: dict[float, tuple[float, int, bool]] = {}

    def place(turn: float) -> np.ndarray:
        return last + radius * np.array([np.cos(middle + turn), np.sin(middle + turn)])

    def gap(turn: float) -> float:
        """Signed distance of the image of a point of the circle from the curve; 0 if the image lies on it."""
        if turn not in sides:
            sides[turn] = _signed_distance(*curve, image(place(turn)))
        value = sides[turn][0]
        return 0.0 if abs(value) < near else value

    count = int(np.ceil(ARCS * max(1.0, widest))) if widest > TURN else ARCS
    turns = [float(turn) for turn in widest * np.linspace(-1.0, 1.0, count + 1)]
    for low, high in sorted(pairwise(turns), key=lambda ends: abs(ends[0] + ends[1])):
        a, b = gap(low), gap(high)
        if not (np.isfinite(a) and np.isfinite(b)) or a * b > 0.0:
            continue
        try:
            turn: float = brentq(gap, low, high, xtol=TINY, maxiter=REFINED, disp=False)  # pyright: ignore[reportAssignmentType]
        except ValueError:  # the image is not finite
            return None
        distance, (_, segment, beyond) = gap(turn), sides[turn]
        if not beyond and abs(distance) <= MANIFOLDS.jump * radius:  # otherwise the map is discontinuous
            return place(turn), segment, abs(turn)
    return None


def _signed_distance(
    starts: np.ndarray, ends: np.ndarray, at: int, point: np.ndarray
) -> tuple[float, int, bool]:
    """Return the signed distance of a point from the known curve, the nearest segment, and whether the point lies beyond the curve's end.

    Only segments from number ``at - 2`` on are searched. Beyond the end, the distance is that to the line of the last segment: its sign
    still shows to which side of the manifold the saddle's unstable direction sends the point.
    """
    if not np.all(np.isfinite(point)):
        return float("nan"), at, False
    first = max(at - 2, 0)
    starts, ends = starts[first:], ends[first:]
    along = ends - starts
    lengths = np.maximum((along * along).sum(axis=1), TINY)
    part = ((point - starts) * along).sum(axis=1) / lengths
    inside = np.clip(part, 0.0, 1.0)
    gaps = np.linalg.norm(point - (starts + inside[:, None] * along), axis=1)
    k = int(gaps.argmin())
    offset = along[k, 0] * (point - starts[k])[1] - along[k, 1] * (point - starts[k])[0]
    if k == len(gaps) - 1 and part[k] > 1.0:
        return float(offset / np.sqrt(lengths[k])), at, True
    return float(np.sign(offset) * gaps[k]), first + k, False
