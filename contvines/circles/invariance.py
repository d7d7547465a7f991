"""The invariance equation of a circle: P(x(phi)) = x(phi + 2 pi rho), solved by collocation and Newton's method.

x(phi) is a trigonometric polynomial through n = 2 K + 1 points. The rotation number rho and the parameter p are unknowns, too. The phase is fixed by
the condition that the first harmonic is real, and one linear condition selects a circle of the family (`Condition`). The method works for stable and
unstable circles. P is the return map of the section; its derivatives are computed by differences if the section does not provide them.

Source of the method: Schilder, Osinga and Vogt, SIAM J. Appl. Dyn. Syst. 4 (2005) 459, for flows; here for section maps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..shared.numbers import TINY
from .section import Imaged, Section, Varied, slopes

INSIDE = 0.01  # largest step of differences, relative to the radius of the circle and to the distance from its birth
SWEEPS = 15  # most steps of Newton's method


@dataclass(frozen=True)
class CircleSettings:
    """Tolerances of invariant circles.

    Attributes
    ----------
    step, least_step : float
        Differences: step, relative to the sizes of the section, the unknowns and the parameter; smallest step near a small circle.
    crossing : tuple of float
        Differences: steps in the parameter, relative to its size, for the derivative of the multipliers at the birth; small ones are needed if a fold,
        or the end of the pair, is near.
    least_parameter : float
        Differences: smallest typical size of a parameter.
    solved : float
        Newton's method: residual of a solution, relative to the radius.
    rounded, rough : float
        Newton's method: residual accepted when rounding stops convergence, relative to the size of the section; it must also be below `rough`, relative
        to the radius.
    beginning : float
        Family: smallest first amplitude, relative to the usual one.
    smooth, broken : float
        Ends: size of the last harmonics, relative to the first, below which a circle has enough points, and above which it is broken.
    image_distance : float
        Ends: largest distance of a circle's images from it, between its points and relative to its radius.
    displaced : float
        Simulation: displacement, relative to the radius, whose growth or decay decides the stability.
    settled : float
        Simulation: difference between the rotation numbers of all returns and of half of them at which they have converged.
    far, same : float
        Simulation: distance at which a motion has escaped, and largest distance of equal returns, relative to the size of the section.
    """

    step: float = 1e-6
    least_step: float = 1e-13
    crossing: tuple[float, ...] = (1e-5, 1e-6, 1e-7, 1e-8)
    least_parameter: float = 1e-3
    solved: float = 1e-10
    rounded: float = 1e-11
    rough: float = 1e-4
    beginning: float = 1e-4
    smooth: float = 1e-7
    broken: float = 3e-3
    image_distance: float = 1e-3
    displaced: float = 1e-3
    settled: float = 1e-11
    far: float = 1e3
    same: float = 1e-8


CIRCLES = CircleSettings()


class Frame(NamedTuple):
    """Coordinate of the critical plane, and typical sizes.

    Attributes
    ----------
    left : ndarray of complex, shape (d,)
        Left critical eigenvector: z = conj(left).x is the coordinate of a displacement in the critical plane.
    size : float
        Typical size of the section's coordinates.
    unit : float
        Typical size of the parameter.
    origin : float
        Parameter value at which the circles are born.
    """

    left: np.ndarray
    size: float
    unit: float
    origin: float


class Curve(NamedTuple):
    """A closed curve on the section with its rotation number and parameter value.

    Attributes
    ----------
    points : ndarray, shape (n, d)
        Points at equal steps of the phase.
    rotation, value, residual : float
        Rotation number, parameter value, and residual relative to the radius.
    """

    points: np.ndarray
    rotation: float
    value: float
    residual: float = np.inf

    @property
    def harmonics(self) -> np.ndarray:
        """Fourier coefficients, shape (n, d), in the order of numpy's FFT."""
        return np.fft.fft(self.points, axis=0) / len(self.points)

    @property
    def tail(self) -> float:
        """Size of the largest of the last tenth of the harmonics, relative to the first one."""
        half = len(self.points) // 2
        sizes = np.abs(self.harmonics[1 : half + 1]).max(axis=1)
        return float(sizes[-max(1, half // 10) :].max() / sizes[0])

    def at(self, phases: np.ndarray) -> np.ndarray:
        """Return the points at phases (radians), shape (m, d)."""
        n = len(self.points)
        k = np.fft.fftfreq(n, 1.0 / n)
        return np.real(np.exp(1j * np.outer(np.asarray(phases), k)) @ self.harmonics)

    def beyond(self, before: Curve, share: float, bend: float) -> Curve:
        """Extrapolate from another curve beyond this one: the points by the factor `share` of their difference, rotation and parameter by `bend`."""
        return Curve(
            self.points + share * (self.points - before.points),
            self.rotation + bend * (self.rotation - before.rotation),
            self.value + bend * (self.value - before.value),
        )

    def finer(self, count: int) -> Curve:
        """Return the same curve with another number of points."""
        phases = 2.0 * np.pi * np.arange(count) / count
        return self._replace(points=self.at(phases))


class Condition(NamedTuple):
    """Condition that selects a circle of a family: normal . (amplitude of the first harmonic, rotation number, parameter) = target."""

    normal: tuple[float, float, float]
    target: float


def of_amplitude(amplitude: float) -> Condition:
    """Return the condition of a given amplitude of the first harmonic."""
    return Condition((1.0, 0.0, 0.0), amplitude)


def at_value(value: float) -> Condition:
    """Return the condition of a given parameter value."""
    return Condition((0.0, 0.0, 1.0), value)


def between(section: Section, curve: Curve) -> float:
    """Return the largest distance of simulated images of a circle from it, for points between those at which it was solved."""
    count = 2 * len(curve.points)
    phases = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    images = np.array([section.step(x) for x in curve.at(phases)])
    return float(np.abs(images - curve.at(phases + 2.0 * np.pi * curve.rotation)).max())


def first_harmonic(curve: Curve, frame: Frame) -> complex:
    """Return the first harmonic of a curve in the critical plane."""
    return complex(frame.left.conj() @ curve.harmonics[1])


def _images(section: Section, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The next points (n, d), their derivatives by the points (n, d, d) and by the parameter (n, d); NaN for derivatives that the section does not provide."""
    n, d = points.shape
    if isinstance(section, Imaged):
        return section.images(points)
    by_state, by_value = np.full((n, d, d), np.nan), np.full((n, d), np.nan)
    if not isinstance(section, Varied):
        return np.array([section.step(x) for x in points]), by_state, by_value
    images = np.empty((n, d))
    for j, x in enumerate(points):
        images[j], by_state[j], by_value[j] = section.varied(x)
    return images, by_state, by_value


def _differences(
    section: Callable[[float], Section],
    points: np.ndarray,
    p: float,
    steps: tuple[float, float],
    by_state: np.ndarray,
    by_value: np.ndarray,
) -> None:
    """Fill in missing (NaN) derivatives by differences with given steps in the points and in the parameter, in place."""
    unknown = np.flatnonzero(~np.isfinite(by_state).all(axis=(1, 2)))
    if not len(unknown):
        return
    middle, after, before = section(p), section(p + steps[1]), section(p - steps[1])
    for j in unknown:
        by_state[j] = slopes(middle, points[j], steps[0])
        by_value[j] = (after.step(points[j]) - before.step(points[j])) / (2.0 * steps[1])


def solve(
    section: Callable[[float], Section], guess: Curve, frame: Frame, condition: Condition
) -> Curve | None:
    """Solve for the invariant circle near a curve that fulfils a condition; None if Newton's method fails.

    Parameters
    ----------
    section : callable
        Parameter value -> section.
    guess : Curve
    frame : Frame
    condition : Condition
    """
    n, d = guess.points.shape
    k = np.fft.fftfreq(n, 1.0 / n)
    # harmonics = fourier @ points
    fourier = np.exp(-2j * np.pi * np.outer(np.arange(n), np.arange(n)) / n) / n
    phases = 2.0 * np.pi * np.arange(n) / n
    first = np.exp(-1j * phases) / n
    points, rho, p = guess.points.copy(), guess.rotation, guess.value
    normal, target = condition
    length = np.linalg.norm(np.array(normal) * (frame.size, 1.0, frame.unit)) / frame.size
    radius = max(abs(first_harmonic(guess, frame)), TINY)
    h = max(min(CIRCLES.step * frame.size, INSIDE * radius), CIRCLES.least_step * frame.size)
    width = max(
        min(CIRCLES.step * frame.unit, INSIDE * abs(guess.value - frame.origin)),
        CIRCLES.least_step * frame.unit,
    )
    last = np.inf
    for _ in range(SWEEPS):
        images, by_state, by_value = _images(section(p), points)
        # matrix from the points to the values at the next phases
        turned = np.exp(1j * np.outer(phases + 2.0 * np.pi * rho, k)) @ fourier
        shifted = np.real(turned @ points)
        z = complex(first @ (points @ frame.left.conj()))
        off_plane = normal[0] * z.real + normal[1] * rho + normal[2] * p - target
        ends = np.array([z.imag, off_plane / length])
        sides = np.concatenate([(images - shifted).reshape(-1), ends])
        if not np.isfinite(sides).all():
            return None
        error = float(np.abs(sides).max()) / radius
        rounded = (
            error * radius < CIRCLES.rounded * frame.size and error < CIRCLES.rough and error > 0.25 * last
        )
        if error < CIRCLES.solved or rounded:
            return Curve(points, float(rho), float(p), error)
        if not error < 2.0 * last:
            return None
        last = error
        size = n * d
        matrix = np.zeros((size + 2, size + 2))
        blocks = matrix[:size, :size].reshape(n, d, n, d)
        _differences(section, points, p, (h, width), by_state, by_value)
        for j, block in enumerate(by_state):
            blocks[j, :, j, :] += block
        for c in range(d):
            blocks[:, c, :, c] -= np.real(turned)
        turning = np.exp(1j * np.outer(phases + 2.0 * np.pi * rho, k)) @ (
            (2j * np.pi * k)[:, None] * (fourier @ points)
        )
        matrix[:size, size] = -np.real(turning).reshape(-1)
        matrix[:size, size + 1] = by_value.reshape(-1)
        along = np.outer(first, frame.left.conj()).reshape(-1)
        matrix[size, :size] = np.imag(along)
        matrix[size + 1, :size] = normal[0] / length * np.real(along)
        matrix[size + 1, size:] = normal[1] / length, normal[2] / length
        if not np.isfinite(matrix).all():
            return None
        try:
            change = np.linalg.solve(matrix, -sides)
        except np.linalg.LinAlgError:
            return None
        points = points + change[:size].reshape(n, d)
        rho, p = rho + float(change[size]), p + float(change[size + 1])
    return None


# ------------------------------------------------------------------ averages
def weights(count: int) -> np.ndarray:
    """Return smooth weights with sum one for an average of `count` successive values."""
    t = (np.arange(count) + 1.0) / (count + 1.0)
    bump = np.exp(-1.0 / (t * (1.0 - t)))
    return bump / bump.sum()


def rotation_number(z: np.ndarray, near: float) -> tuple[float, float]:
    """Return the turns per step, and the estimated error, of a sequence of complex numbers that rotates around zero.

    Averages along quasi-periodic sequences with the weight exp(-1/(t (1 - t))) converge faster than any power of their length.
    Source: Das, Saiki, Sander and Yorke, Nonlinearity 30 (2017) 4111.

    Parameters
    ----------
    z : ndarray of complex, shape (m,)
    near : float
        Approximate rotation number, with an error below half a turn.
    """
    turns = np.angle(z[1:] / z[:-1]) / (2.0 * np.pi)
    turns = near + (turns - near + 0.5) % 1.0 - 0.5
    whole = float(weights(len(turns)) @ turns)
    half = len(turns) // 2
    return whole, abs(whole - float(weights(half) @ turns[:half]))
