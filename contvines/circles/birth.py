"""What is born at a Neimark-Sacker point: the normal form, on the section."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..bifurcation.normal_forms.coefficients import Forms
from ..bifurcation.normal_forms.criticality import strong_resonance
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine
from ..continuation.settings import Settings
from ..flows.cycles import CycleProblem
from ..problems.abilities import Adaptive
from .invariance import Curve, Frame
from .section import Imaged, Section, section_of, slopes
from .settings import CIRCLES

if TYPE_CHECKING:
    from ..problems.protocol import Problem


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
