"""Family: continuation of invariant circles, first with growing amplitude, then along the family beyond a maximum of the amplitude.

The unknowns of a circle are its points, its rotation number and the parameter. Near the birth of the circles the amplitude is a good parameter of the
family. Near a saddle, where circles born next to a strong resonance end, the motion becomes slow and its first harmonic decreases again while the circle
grows on. There the next circle is computed in the plane perpendicular to the last change of (amplitude, rotation, parameter).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..bifurcation.normal_forms.coefficients import Forms
from ..bifurcation.normal_forms.criticality import strong_resonance
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine
from ..continuation.settings import Settings
from ..flows.cycles import CycleProblem
from ..problems.abilities import Adaptive
from .invariance import (
    CIRCLES,
    Condition,
    Curve,
    Frame,
    at_value,
    between,
    first_harmonic,
    of_amplitude,
    solve,
)
from .section import Imaged, Section, section_of, slopes

if TYPE_CHECKING:
    from ..problems.protocol import Problem

FEWEST, MOST = 17, 257  # fewest and most points of a circle
LESS = 0.25  # doubling the points must reduce the last harmonics by this factor; if it does not, the circle touches a border and is not smooth
# first amplitude relative to the last one; largest and smallest ratio of successive amplitudes
FIRST, GROWTH, SLOWEST = 0.04, 1.35, 1.05
LONGEST = 0.3  # largest step along the family, in units of amplitude, rotation and distance from the birth
# factors of the step that are tried in turn; longer steps can pass a rational rotation at which motions lock
TRIES = (1.0, 0.5, 1.6, 0.25, 2.4, 0.12, 0.06)
LEAST = 0.01  # smallest step along the family
# distance of a rotation number from n/q, times q^2, below which motions lock; largest q
LOCKED, PERIODS = 0.05, 40
# distance outside the circle, relative to its radius, at which motions are tested: if they do not return, there is no larger circle
OUTSIDE = 0.1
# a circle ends near another cycle if its rotation number is below this part of that at its birth
SLOW_ROTATION = 0.5

Sections = Callable[[float], Section]


class Birth(NamedTuple):
    """The normal form of the circles, on the section.

    Attributes
    ----------
    p : float
        Parameter value of the birth.
    coefficient : float
        First Lyapunov coefficient.
    growth : float
        d(log abs(multiplier))/dp.
    rotation : float
        Rotation number at the birth.
    vector : ndarray of complex, shape (d,)
        Critical eigenvector of the section's map.
    frame : Frame
    centre : ndarray, shape (d,)
        The cycle on the section.
    size : float
        Ratio of the amplitude on the section to that of the normal form.
    """

    p: float
    coefficient: float
    growth: float
    rotation: float
    vector: np.ndarray
    frame: Frame
    centre: np.ndarray
    size: float

    def value(self, amplitude: float) -> float:
        """Return the parameter at which the circle has a given amplitude, to lowest order."""
        return self.p - self.coefficient * (amplitude / self.size) ** 2 / self.growth

    def amplitude(self, value: float) -> float:
        """Return the amplitude at a parameter value, to lowest order; 0 on the side without circles."""
        square = -self.growth * (value - self.p) / self.coefficient
        return self.size * float(np.sqrt(max(square, 0.0)))

    def curve(self, amplitude: float, count: int) -> Curve:
        """Return the circle of a given amplitude, to first order, through `count` points."""
        phases = 2.0 * np.pi * np.arange(count) / count
        points = self.centre + 2.0 * amplitude * np.real(np.exp(1j * phases)[:, None] * self.vector)
        return Curve(points, self.rotation, self.value(amplitude))


def problem_at(point: SpecialPoint) -> Problem:
    """Return the problem of a point; for cycles of a flow one that starts at the point, so that the section is the plane across this cycle."""
    problem = point.attached
    if not isinstance(problem, CycleProblem):
        return problem
    return problem.with_unknowns(point.u, float(point.value), problem.intervals, problem.copies)


def birth_at(point: SpecialPoint, problem: Problem) -> Birth:
    """Compute the normal form of the circles near a point; `problem` is the result of `problem_at`.

    Raises
    ------
    ValueError
        At a strong resonance, if the first Lyapunov coefficient is zero within its error, or if the multipliers do not cross the unit circle.
    """
    u, p = point.u, float(point.value)
    multiplier, growth = _crossing(point)
    full = complex(np.asarray(problem.to_multipliers(np.array([multiplier])))[0])
    resonance = strong_resonance(full)
    if resonance:
        raise ValueError(
            f"{point.label} is at the strong resonance {resonance}: no single circle is born there; move a second parameter"
        )
    section = section_of(problem, p)
    centre = section.through(u)
    size = float(np.linalg.norm(centre)) or 1.0
    exact = isinstance(section, Imaged)
    matrix = section.images(centre[None])[1][0] if exact else slopes(section, centre, CIRCLES.step * size)
    values, right = np.linalg.eig(matrix)
    place = int(np.argmin(np.abs(values - full)))
    vector = right[:, place] / np.linalg.norm(right[:, place])
    left = np.linalg.inv(right)[place].conj()
    left = left / np.vdot(left, vector).conj()
    if isinstance(section, Imaged) and isinstance(problem, Adaptive):
        value, _ = problem.normal_form("neimark-sacker", u, p, multiplier) or (0.0, 0.0)
        decided, amplitude = bool(value), 1.0 / section.length(vector)
    else:
        forms = Forms(problem, u, p)
        found, _ = forms.lyapunov(multiplier)
        value, decided = found.value, abs(found.value) > 2.0 * found.error
        amplitude = float(np.abs(np.vdot(left, _image(section, forms, multiplier, u))))
    if not decided:
        raise ValueError(
            f"{point.label}: its first Lyapunov coefficient is zero within its error, so no side is known"
        )
    if growth == 0.0:
        raise ValueError(f"{point.label}: the multipliers only touch the unit circle there")
    frame = Frame(left, size, max(abs(p), CIRCLES.least_parameter), p)
    turns = float(np.angle(full)) / (2.0 * np.pi)
    return Birth(p, value, growth, turns, vector, frame, centre, amplitude)


def _image(section: Section, forms: Forms, multiplier: complex, u: np.ndarray) -> np.ndarray:
    """The critical eigenvector of the problem as a direction on the section."""
    q = forms.null(multiplier / abs(multiplier))[0] * forms.units
    h = CIRCLES.step * (float(np.linalg.norm(u)) or 1.0)
    along = [
        (section.through(u + h * part) - section.through(u - h * part)) / (2.0 * h)
        for part in (np.real(q), np.imag(q))
    ]
    return along[0] + 1j * along[1]


def _crossing(point: SpecialPoint) -> tuple[complex, float]:
    """The raw critical multiplier, and the derivative of the logarithm of its magnitude by p along the cycles."""
    problem, p = point.attached, float(point.value)
    unit = max(abs(p), CIRCLES.least_parameter)
    engine = Engine(problem, (p - unit, p + unit), Settings())

    def critical(value: float, near: complex | None) -> complex | None:
        solved = engine.at_value(point.u, value)
        if solved is None:
            return None
        upper = engine.spectrum(solved.row)
        upper = upper[upper.imag > 0.0]
        distance = np.abs(np.abs(upper) - 1.0) if near is None else np.abs(upper - near)
        return complex(upper[np.argmin(distance)]) if len(upper) and distance.min() < 0.1 else None

    multiplier = critical(p, None)
    if multiplier is None:
        raise ValueError(f"{point.label} has no complex pair of multipliers on the unit circle")
    for step in CIRCLES.crossing:
        rates = []
        for width in (step * unit, 0.5 * (step * unit)):
            above, below = critical(p + width, multiplier), critical(p - width, multiplier)
            if above is None or below is None:
                break
            rates.append(np.log(abs(above / below)) / (2.0 * width))
        if len(rates) == 2 and abs(rates[1] - rates[0]) <= 0.02 * abs(rates[1]):
            return multiplier, float((4.0 * rates[1] - rates[0]) / 3.0)
    raise ValueError(f"{point.label}: its cycle cannot be followed to both sides")


@dataclass(eq=False)
class Family:
    """The family of circles that is born at a point, and its continuation.

    Attributes
    ----------
    section : callable
        Parameter value -> section.
    birth : Birth
    amplitude : float
        Largest amplitude, if `to` is None.
    to : float or None
        Parameter value at which the family ends.
    side : float
        1 if the circles lie above the parameter value of their birth, -1 if below.
    count : int
        Most circles.
    name : str
        Name of the parameter.
    found : list of Curve
        Circles found so far, in order.
    """

    section: Sections
    birth: Birth
    amplitude: float
    to: float | None
    side: float
    count: int
    name: str
    found: list[Curve] = field(default_factory=list)

    def follow(self) -> str:
        """Compute circles of growing amplitude, then along their family; return the sentence why the family ends."""
        return self._continue_growing() or self._continue_on()

    def _continue_growing(self) -> str | None:
        """Continue by growing amplitude; return the sentence why the family ends, or None if a larger amplitude is not found."""
        amplitude, factor, points, frame = FIRST * self.amplitude, GROWTH, FEWEST, self.birth.frame
        while len(self.found) < self.count:
            curve, _ = self._smooth(self._predict_larger(amplitude, points), of_amplitude(amplitude))
            if curve is None:
                if not self.found:
                    amplitude *= 0.5
                    if amplitude < CIRCLES.beginning * FIRST * self.amplitude:
                        raise ValueError(
                            "no circle was found beside the point; the normal form may not hold there"
                        )
                    continue
                factor = 1.0 + 0.5 * (factor - 1.0)
                if factor < SLOWEST:
                    return None
                amplitude = factor * abs(first_harmonic(self.found[-1], frame))
                continue
            if ended := self._arrived(curve, amplitude):
                return ended
            points = len(curve.points)
            amplitude *= factor
            factor = min(GROWTH, 1.0 + 1.5 * (factor - 1.0))
            if self.to is None:
                amplitude = min(amplitude, self.amplitude)
        return self._enough()

    def _continue_on(self) -> str:
        """Continue along the family; return the sentence why it ends."""
        step, found = LONGEST, self.found
        while len(found) < self.count:
            before = self.birth.curve(0.0, len(found[-1].points)) if len(found) == 1 else found[-2]
            torn = False
            for part in TRIES:
                curve, broken = self._smooth(*self._predict_next(before, found[-1], part * step))
                if curve is not None:
                    break
                torn = torn or broken
            else:
                return self._reason_of_break(found[-1], torn)
            if ended := self._arrived(curve, abs(first_harmonic(curve, self.birth.frame))):
                return ended
            step = min(LONGEST, 1.3 * part * step)
            if step < LEAST:
                return self._reason_of_break(curve, curve.tail > CIRCLES.smooth)
        return self._enough()

    def _arrived(self, curve: Curve, amplitude: float) -> str | None:
        """Add a circle; at the end of the requested interval or amplitude, return the sentence for it (else None)."""
        if self.to is not None and (curve.value - self.to) * self.side >= 0.0:
            last = solve(self.section, curve._replace(value=self.to), self.birth.frame, at_value(self.to))
            self.found += [] if last is None else [last]
            return f"reaches {self.name} = {self.to:.8g}"
        self.found.append(curve)
        if self.to is None and amplitude >= self.amplitude:
            return f"has half the size of the motion at {self.name} = {curve.value:.8g}"
        return None

    def _enough(self) -> str:
        return f"stopped after {self.count} circles at {self.name} = {self.found[-1].value:.8g}"

    def _reason_of_break(self, last: Curve, torn: bool) -> str:
        """Sentence why circles end after the last one."""
        at, at_birth = f"near {self.name} = {last.value:.8g}", self.birth.rotation
        if abs(last.rotation) < SLOW_ROTATION * abs(at_birth):
            return (
                f"ends {at}, where its turns take {abs(at_birth / last.rotation):.3g} times as long as at its birth: "
                "the circle comes close to another cycle, beside which the motion lingers"
            )
        n, q = min(
            ((round(last.rotation * q), q) for q in range(1, PERIODS + 1)),
            key=lambda ratio: abs(last.rotation * ratio[1] - ratio[0]) * ratio[1],
        )
        if n and abs(last.rotation * q - n) * q < LOCKED:
            return f"the circle breaks {at}: its rotation {last.rotation:.5g} comes close to {n}/{q}, at which motions lock"
        outside = last.points + OUTSIDE * (last.points - last.points.mean(axis=0))
        if not np.isfinite([self.section(last.value).step(x) for x in outside]).all():
            return (
                f"ends {at}: motions from points a little outside of the circle do not return, or the points are impossible states (at the section, "
                "the motion is next to a wall)"
            )
        reason = "it is no longer smooth" if torn else "it cannot be followed any further"
        return f"the circle breaks {at}: {reason}"

    def _predict_larger(self, amplitude: float, count: int) -> Curve:
        """Predict the next circle from the last two: points linear in the amplitude, rotation and parameter linear in its square."""
        if not self.found:
            return self.birth.curve(amplitude, count)
        last, frame = self.found[-1].finer(count), self.birth.frame
        before, r, r0 = self.birth.curve(0.0, count), abs(first_harmonic(last, frame)), 0.0
        if len(self.found) > 1:
            before = self.found[-2].finer(count)
            r0 = abs(first_harmonic(before, frame))
        share, bend = (amplitude - r) / (r - r0), (amplitude**2 - r**2) / (r**2 - r0**2)
        return last.beyond(before, share, bend)

    def _predict_next(self, before: Curve, last: Curve, step: float) -> tuple[Curve, Condition]:
        """Predict the next circle in the direction of the last change; return it with the condition of the plane perpendicular to this direction."""
        current, previous = (
            np.array([first_harmonic(curve, self.birth.frame).real, curve.rotation, curve.value])
            for curve in (last, before)
        )
        sizes = np.abs(current - (0.0, 0.0, self.birth.p))
        change = (current - previous) / sizes
        share = step / float(np.linalg.norm(change))
        a, b, c = (change / np.linalg.norm(change) / sizes).tolist()
        target = float(np.dot((a, b, c), current)) + step
        guess = last.beyond(before.finer(len(last.points)), share, share)
        return guess, Condition((a, b, c), target)

    def _smooth(self, guess: Curve, condition: Condition) -> tuple[Curve | None, bool]:
        """Solve for a circle with enough points; return it (None if there is none), and whether the solution found is no smooth closed curve."""
        frame, before, curve = self.birth.frame, None, solve(self.section, guess, self.birth.frame, condition)
        while curve is not None:
            worse = before is not None and LESS * before.tail < curve.tail and before.tail < CIRCLES.broken
            if worse or curve.tail < CIRCLES.smooth or len(curve.points) >= MOST:
                curve = before if before is not None and worse else curve
                missed = CIRCLES.image_distance * abs(first_harmonic(curve, frame))
                torn = curve.tail > CIRCLES.broken or not between(self.section(curve.value), curve) < missed
                return (None if torn else curve), torn
            before = curve
            finer = curve.finer(min(MOST, 2 * len(curve.points) - 1))
            curve = solve(self.section, finer, frame, condition)
        return None, False
