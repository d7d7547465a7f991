"""Invariant circles of a Neimark-Sacker point: normal form, continuation, and comparison with simulations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice
from typing import Any

import numpy as np

from ..branches.special_point import SpecialPoint
from ..continuation.settings import hinting
from ..long_work import listening
from ..problems.abilities import notation_of
from ..problems.registry import without_problem
from ..shared.numbers import TINY
from .along import Birth, Family, birth_at, problem_at
from .circle import Circle, Circles
from .invariance import CIRCLES, Curve, between, rotation_number
from .section import Section, Watched, section_of

# largest amplitude, relative to the size of the section, if no parameter value is given as the end
REACH = 0.5
COUNT = 40  # default for the most circles
RETURNS = 3000  # most returns of a simulation on a circle ...
FIRST = 375  # ... whose rotation number is tested for convergence after so many returns, then each time after twice as many
PATIENCE = 6000  # most returns until a simulation settles
LONGEST = 200  # most periods of a locked motion
LOOK = 200  # returns after which a displacement is tested for growth or decay, then each time after twice as many; ...
# ... at least so many turns of the slow drift next to a resonance of at most this order
ROUNDS, RESONANCES = 4, 6
CLEAR = 5.0  # ratio of the largest displacements in the two halves at which growth or decay is clear


@hinting
@listening()
def circles(point: SpecialPoint, to: float | None = None, count: int = COUNT) -> Circles:
    """Compute the invariant circles that are born at a Neimark-Sacker point, until they break.

    Parameters
    ----------
    point : SpecialPoint
        A point of kind "neimark-sacker".
    to : float, optional
        Parameter value at which to stop, on the side of the circles; by default they are continued until their amplitude is half the
        size of the motion.
    count : int
        Most circles.

    Returns
    -------
    Circles

    Raises
    ------
    ValueError
        If no circle is found, the normal form is degenerate, or the motion cannot be simulated.
    """
    if point.kind != "neimark-sacker":
        raise ValueError(
            f"{point.label} is a point of kind {point.kind}; invariant circles are born at Neimark-Sacker points"
        )
    if point.problem is None:
        raise ValueError(without_problem(point.label))
    if count < 1:
        raise ValueError(f"count = {count} must be a whole number of at least 1")
    problem = problem_at(point)
    birth = birth_at(point, problem)
    side = 1.0 if birth.value(1.0) > point.value else -1.0
    if to is not None and not (to - point.value) * side > 0.0:
        raise ValueError(
            f"to = {to:.10g}: the circles of {point.label} lie at {point.parameter} "
            f"{'above' if side > 0 else 'below'} {point.value:.10g}; give a value there"
        )

    def section(p: float) -> Section:
        return section_of(problem, p)

    largest = REACH * birth.frame.size if to is None else birth.amplitude(to)
    family = Family(section, birth, largest, to, side, count, point.parameter)
    ended, found = family.follow(), family.found
    at_point = section(point.value)
    solved = tuple(_circle(section, curve, birth) for curve in found)
    beyond = _motion_beyond(section, found, birth) if found else {}
    unit = (point.problem.describe().get("units") or {}).get(point.parameter)
    return Circles(
        point.label,
        point.parameter,
        point.value,
        birth.rotation,
        birth.coefficient,
        birth.growth,
        at_point.names,
        birth.centre,
        solved,
        ended,
        beyond,
        notation_of(point.problem),
        {point.parameter: unit} if unit else {},
    )


# ---------------------------------------------------------------------- comparison with simulations
def _circle(section: Callable[[float], Section], curve: Curve, birth: Birth) -> Circle:
    """A circle as data, with its replay, stability and simulated rotation number."""
    at_value = section(curve.value)
    centre = curve.points.mean(axis=0)
    radius = float(np.sqrt(np.mean(np.sum((curve.points - centre) ** 2, axis=1))))
    replay = between(at_value, curve)
    stable = _attracts(at_value, curve, birth, centre)
    simulated = _simulated(at_value, curve, birth, centre, radius) if stable else None
    # the displacement decreased at first, but the simulation leaves the circle
    if stable and simulated is None:
        stable = None
    amplitude = birth.amplitude(curve.value)
    predicted = float(np.sqrt(2.0) * amplitude)  # rms of 2 Re(r q exp(i phi)) with abs(q) = 1
    return Circle(
        curve.value,
        radius,
        predicted,
        curve.rotation,
        curve.points,
        curve.tail,
        curve.residual,
        replay,
        simulated,
        stable,
    )


def _displacements(
    section: Section, curve: Curve, birth: Birth, centre: np.ndarray, x: np.ndarray
) -> Iterator[float]:
    """Generate, for each return, log(distance of the motion from the centre / distance of the circle at the same angle), in the critical plane."""
    coordinates = (curve.at(np.linspace(0.0, 2.0 * np.pi, 721)) - centre) @ birth.frame.left.conj()
    angles = np.unwrap(np.angle(coordinates))
    if angles[-1] < angles[0]:
        coordinates, angles = coordinates[::-1], angles[::-1]
    while np.isfinite(x := section.step(x)).all():
        z = complex((x - centre) @ birth.frame.left.conj())
        place = angles[0] + (np.angle(z) - angles[0]) % (2.0 * np.pi)
        yield float(np.log(max(abs(z), TINY)) - np.log(np.interp(place, angles, np.abs(coordinates))))


def _attracts(section: Section, curve: Curve, birth: Birth, centre: np.ndarray) -> bool | None:
    """Whether a motion that is displaced outwards returns to the circle; None if that is not clear."""
    rate = 2.0 * abs(birth.growth * (curve.value - birth.p))
    count = int(min(_returns(section, PATIENCE), max(200, 2.0 / max(rate, 1.0 / PATIENCE))))
    start = curve.points[0] + CIRCLES.displaced * (curve.points[0] - centre)
    distances = _displacements(section, curve, birth, centre, start)
    logs = np.empty(0)
    returns = int(min(count, max(LOOK, ROUNDS / _slowest(curve.rotation))))
    while True:
        logs = np.append(logs, np.abs(list(islice(distances, returns - len(logs)))))
        if len(logs) < returns:
            return False
        if returns == count:
            part = max(20, count // 10)
            share = float(np.mean(logs[-part:]) / np.mean(logs[:part]))
            return True if share < 0.8 else False if share > 1.25 else None
        share = float(logs[returns // 2 :].max() / logs[: returns // 2].max())
        if not 1.0 / CLEAR < share < CLEAR:
            return share < 1.0
        returns = min(2 * returns, count)


def _returns(section: Section, most: int) -> int:
    """Most returns of a simulation: `most`, or the section's own limit if its steps are expensive."""
    return min(most, section.returns_watched) if isinstance(section, Watched) else most


def _slowest(rotation: float) -> float:
    """Turns per return of the slow drift next to a resonance; a displacement grows and shrinks once in each turn."""
    drifts = [abs(q * rotation - round(q * rotation)) for q in range(1, RESONANCES + 1)]
    return max(min(drifts), 1.0 / PATIENCE)


def _simulated(
    section: Section, curve: Curve, birth: Birth, centre: np.ndarray, radius: float
) -> float | None:
    """Rotation number of a simulation on the circle; None if it leaves the circle."""
    most = _returns(section, RETURNS)
    x, z, returns = curve.points[0], np.empty(most, dtype=complex), FIRST
    outline = curve.at(np.linspace(0.0, 2.0 * np.pi, 721))
    for i in range(most):
        x = section.step(x)
        z[i] = (x - centre) @ birth.frame.left.conj()
        if i + 1 < min(returns, most):
            continue
        returns *= 2
        if not np.isfinite(z[: i + 1]).all():
            return None
        if np.sqrt(((outline - x) ** 2).sum(axis=1).min()) > 0.02 * radius:
            return None
        turns, error = rotation_number(z[: i + 1], curve.rotation)
        if error < CIRCLES.settled or i + 1 == most:
            return turns
    return None


def _motion_beyond(section: Callable[[float], Section], found: list[Curve], birth: Birth) -> dict[str, Any]:
    """The motion on which a simulation a little beyond the last circle settles; see :attr:`Circles.beyond`."""
    last = found[-1]
    before = found[-2].value if len(found) > 1 else birth.p
    value = last.value + 0.25 * (last.value - before)
    at_value, x = section(value), last.points[0]
    far = CIRCLES.far * birth.frame.size
    same = CIRCLES.same * birth.frame.size
    patience = _returns(at_value, PATIENCE)
    for returns in (patience // 20, patience // 4, patience):
        for _ in range(returns):
            x = at_value.step(x)
            if not np.linalg.norm(x) < far:
                return {"value": value, "kind": "leaves"}
        first = x
        for n in range(1, LONGEST + 1):
            x = at_value.step(x)
            if np.abs(x - first).max() < same:
                return {"value": value, "kind": "locked" if n > 1 else "fixed", "periods": n}
    return {"value": value, "kind": "wandering"}
