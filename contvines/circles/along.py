"""From circle to circle: by growing amplitude at first, then along the curve of circles where the amplitude turns back.

Unknowns of a circle are its points, its rotation number and the parameter. Near its birth the amplitude is a good parameter of the family. Near a
saddle, where circles born beside a strong resonance end, the motion lingers and its first harmonic shrinks again, while the circle goes
on: there each circle is looked for on the plane across the last change of (amplitude, rotation, parameter).
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

FEWEST, MOST = 17, 257  # points of a circle
LESS = 0.25  # by which twice the points make the last harmonics smaller at least: a circle that meets a border has no more derivatives to show
# first amplitude relative to the last one, factors from one to the next
FIRST, GROWTH, SLOWEST = 0.04, 1.35, 1.05
LONGEST = 0.3  # step along the family, where amplitude, rotation and distance from the birth count 1 each
# times the step: longer ones leap over motions locked at a rational rotation
TRIES = (1.0, 0.5, 1.6, 0.25, 2.4, 0.12, 0.06)
LEAST = 0.01  # steps below this go nowhere
# distance of a rotation number from n/q, times q^2: where it is that near, motions lock; largest q
LOCKED, PERIODS = 0.05, 40
# of the radius: where motions so far outside do not come back to the section, no larger circle is seen there
OUTWARDS = 0.1
LINGERS = 0.5  # part of its rotation at birth below which a circle's motion is said to linger

Sections = Callable[[float], Section]


class Birth(NamedTuple):
    """The normal form on the section.

    size : float
        Amplitude on the section per amplitude of the normal form.
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
        """The parameter at which the circle has this amplitude, to lowest order."""
        return self.p - self.coefficient * (amplitude / self.size) ** 2 / self.growth

    def amplitude(self, value: float) -> float:
        """The amplitude at a parameter value; 0 on the other side."""
        square = -self.growth * (value - self.p) / self.coefficient
        return self.size * float(np.sqrt(max(square, 0.0)))

    def curve(self, amplitude: float, count: int) -> Curve:
        """The circle of an amplitude, to first order."""
        phases = 2.0 * np.pi * np.arange(count) / count
        points = self.centre + 2.0 * amplitude * np.real(np.exp(1j * phases)[:, None] * self.vector)
        return Curve(points, self.rotation, self.value(amplitude))


def anchored(point: SpecialPoint) -> Problem:
    """The problem of a point; of cycles on a mesh the one that begins with the point, across whose cycle sections are taken."""
    problem = point.attached
    if not isinstance(problem, CycleProblem):
        return problem
    return problem.with_unknowns(point.u, float(point.value), problem.intervals, problem.copies)


def born(point: SpecialPoint, problem: Problem) -> Birth:
    """The normal form of the circles beside a point, whose problem is that of `anchored`.

    Raises
    ------
    ValueError
        If it does not decide where they are.
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
    known = isinstance(section, Imaged)
    matrix = section.images(centre[None])[1][0] if known else slopes(section, centre, CIRCLES.step * size)
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
    """The critical vector of the unknowns as a direction of points of the section."""
    q = forms.null(multiplier / abs(multiplier))[0] * forms.units
    h = CIRCLES.step * (float(np.linalg.norm(u)) or 1.0)
    along = [
        (section.through(u + h * part) - section.through(u - h * part)) / (2.0 * h)
        for part in (np.real(q), np.imag(q))
    ]
    return along[0] + 1j * along[1]


def _crossing(point: SpecialPoint) -> tuple[complex, float]:
    """The raw critical multiplier, and d(log abs)/dp along the cycles."""
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

    here = critical(p, None)
    if here is None:
        raise ValueError(f"{point.label} has no complex pair of multipliers on the unit circle")
    for step in CIRCLES.crossing:
        rates = []
        for width in (step * unit, 0.5 * (step * unit)):
            above, below = critical(p + width, here), critical(p - width, here)
            if above is None or below is None:
                break
            rates.append(np.log(abs(above / below)) / (2.0 * width))
        if len(rates) == 2 and abs(rates[1] - rates[0]) <= 0.02 * abs(rates[1]):
            return here, float((4.0 * rates[1] - rates[0]) / 3.0)
    raise ValueError(f"{point.label}: its cycle cannot be followed to both sides")


@dataclass(eq=False)
class Family:
    """The circles beside a point, as far as they are followed.

    Attributes
    ----------
    section : callable
        Parameter value -> section.
    birth : Birth
    amplitude : float
        The largest one, where no end is given.
    to : float or None
        Parameter value.
    side : float
        1 where circles lie above the parameter of their birth, -1 below.
    count : int
        How many at most.
    name : str
        Of the parameter.
    found : list of Curve
        So far, in order.
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
        """Circles of growing amplitude, then along their family; and why there are no more."""
        return self._growing() or self._onwards()

    def _growing(self) -> str | None:
        """By their amplitude, until that will not do; then the sentence is None."""
        amplitude, factor, points, frame = FIRST * self.amplitude, GROWTH, FEWEST, self.birth.frame
        while len(self.found) < self.count:
            curve, _ = self._smooth(self._larger(amplitude, points), of_amplitude(amplitude))
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

    def _onwards(self) -> str:
        """Along the family, as far as circles are smooth."""
        step, found = LONGEST, self.found
        while len(found) < self.count:
            before = self.birth.curve(0.0, len(found[-1].points)) if len(found) == 1 else found[-2]
            torn = False
            for part in TRIES:
                curve, broken = self._smooth(*self._next(before, found[-1], part * step))
                if curve is not None:
                    break
                torn = torn or broken
            else:
                return self._broken(found[-1], torn)
            if ended := self._arrived(curve, abs(first_harmonic(curve, self.birth.frame))):
                return ended
            step = min(LONGEST, 1.3 * part * step)
            if step < LEAST:
                return self._broken(curve, curve.tail > CIRCLES.smooth)
        return self._enough()

    def _arrived(self, curve: Curve, amplitude: float) -> str | None:
        """Keeps a circle, or the one at the end of the way, which is said then."""
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

    def _broken(self, last: Curve, torn: bool) -> str:
        """Why circles end."""
        at, born = f"near {self.name} = {last.value:.8g}", self.birth.rotation
        if abs(last.rotation) < LINGERS * abs(born):
            return (
                f"ends {at}, where its turns take {abs(born / last.rotation):.3g} times as long as at its birth: "
                "the circle comes close to another cycle, beside which the motion lingers"
            )
        n, q = min(
            ((round(last.rotation * q), q) for q in range(1, PERIODS + 1)),
            key=lambda ratio: abs(last.rotation * ratio[1] - ratio[0]) * ratio[1],
        )
        if n and abs(last.rotation * q - n) * q < LOCKED:
            return f"the circle breaks {at}: its rotation {last.rotation:.5g} comes close to {n}/{q}, at which motions lock"
        outside = last.points + OUTWARDS * (last.points - last.points.mean(axis=0))
        if not np.isfinite([self.section(last.value).step(x) for x in outside]).all():
            return (
                f"ends {at}: points a little outside of it are no states of the motion, or run away (where the section is taken, "
                "the motion is next to a wall)"
            )
        why = "it is no longer smooth" if torn else "it cannot be followed any further"
        return f"the circle breaks {at}: {why}"

    def _larger(self, amplitude: float, count: int) -> Curve:
        """The next circle from the last two: harmonics are linear in the amplitude, rotation and parameter in its square."""
        if not self.found:
            return self.birth.curve(amplitude, count)
        last, frame = self.found[-1].finer(count), self.birth.frame
        before, r, r0 = self.birth.curve(0.0, count), abs(first_harmonic(last, frame)), 0.0
        if len(self.found) > 1:
            before = self.found[-2].finer(count)
            r0 = abs(first_harmonic(before, frame))
        share, bend = (amplitude - r) / (r - r0), (amplitude**2 - r**2) / (r**2 - r0**2)
        return last.beyond(before, share, bend)

    def _next(self, before: Curve, last: Curve, step: float) -> tuple[Curve, Condition]:
        """A guess in the direction of the last change, and the plane across it in which the circle is looked for."""
        here, there = (
            np.array([first_harmonic(curve, self.birth.frame).real, curve.rotation, curve.value])
            for curve in (last, before)
        )
        sizes = np.abs(here - (0.0, 0.0, self.birth.p))
        moved = (here - there) / sizes
        share = step / float(np.linalg.norm(moved))
        a, b, c = (moved / np.linalg.norm(moved) / sizes).tolist()
        target = float(np.dot((a, b, c), here)) + step
        guess = last.beyond(before.finer(len(last.points)), share, share)
        return guess, Condition((a, b, c), target)

    def _smooth(self, guess: Curve, condition: Condition) -> tuple[Curve | None, bool]:
        """The circle through as many points as it needs, or whether what was found at so many points is no smooth closed curve."""
        frame, before, curve = self.birth.frame, None, solve(self.section, guess, self.birth.frame, condition)
        while curve is not None:
            worse = before is not None and LESS * before.tail < curve.tail and before.tail < CIRCLES.torn
            if worse or curve.tail < CIRCLES.smooth or len(curve.points) >= MOST:
                curve = before if before is not None and worse else curve
                missed = CIRCLES.apart * abs(first_harmonic(curve, frame))
                torn = curve.tail > CIRCLES.torn or not between(self.section(curve.value), curve) < missed
                return (None if torn else curve), torn
            before = curve
            finer = curve.finer(min(MOST, 2 * len(curve.points) - 1))
            curve = solve(self.section, finer, frame, condition)
        return None, False
