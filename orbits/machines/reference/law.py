"""The numbers of the equations of motion, from the parameters of each built-in machine.

Between two events q1, the cavity, is the sum of a harmonic of the forcing and a damped free oscillation, and q2, the absorber, a parabola:

    q1'' + drag q1' + q1 = e + eps drag-share - eps q2'',    q2'' = s friction + lean,    w = q1 - q2,    v = q1 + eps q2,

if the cavity is an oscillator (`coupled`); q1 and q2 count from rest. A shaken cavity (`absorber`, `cavity`) has the same equations with
eps = 0: q1 = v = C sin Psi independent of the absorber, and q2 multiplied by (1 + eps). So w'' = v'' - (1 + eps)(s friction + lean) for all.

Parameters may be numbers or arrays, real or complex (`orbits.machines.reference.maps` differentiates by complex steps).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

Number = Any
"""A number or an array, real or complex; all arguments of one formula have the same kind."""


def where(condition: np.ndarray | bool, one: Number, other: Number) -> Number:
    """Return numpy's ``where``, as a number if all arguments are numbers."""
    return np.where(condition, one, other)[()]


class Response(NamedTuple):
    """The forced harmonic X sin Psi + Y cos Psi of q1, and decay rate and angular frequency of its free oscillation."""

    X: Number
    Y: Number
    alpha: Number
    beta: Number


class Side(NamedTuple):
    """One direction of sliding: relative acceleration of friction, position of the wall ahead (positive in that direction), its restitution."""

    friction: float
    reach: float
    restitution: float


class Law(NamedTuple):
    """The numbers of the equations of motion.

    Attributes
    ----------
    omega
        Frequency of the forcing.
    friction_left, friction_right, lean
        Accelerations of q2: by friction while sliding to either wall, and by the slope.
    restitution_left, restitution_right, left, right
        Restitution and position of either wall.
    slide, stuck : Response
        Response of q1 while the absorber slides, and while it sticks.
    eps
        Mass ratio (0 for a shaken cavity).
    force, base
        Amplitude of the excitation's sine, and ratio of its cosine to the sine.
    drag
        eps lambda.
    prescribed : bool
        Whether the motion of the cavity is prescribed.
    """

    omega: Number
    friction_left: Number
    friction_right: Number
    lean: Number
    restitution_left: Number
    restitution_right: Number
    left: Number
    right: Number
    slide: Response
    stuck: Response
    eps: Number
    force: Number
    base: Number
    drag: Number
    prescribed: bool

    @property
    def whole(self) -> Number:
        """1 + eps."""
        return 1.0 + self.eps

    @property
    def amplitude(self) -> Number:
        """C, the amplitude of a shaken cavity."""
        return self.slide.X

    @property
    def pull_left(self) -> Number:
        """q2'' while the absorber slides to the left wall."""
        return self.friction_left + self.lean

    @property
    def pull_right(self) -> Number:
        """q2'' while the absorber slides to the right wall."""
        return self.lean - self.friction_right

    def side(self, s: float) -> Side:
        """Return the direction of sliding to the left wall (s > 0) or to the right one."""
        if s > 0.0:
            return Side(self.whole * self.friction_left, self.left, self.restitution_left)
        return Side(self.whole * self.friction_right, -self.right, self.restitution_right)

    @property
    def frictionless(self) -> bool:
        """Whether there is no friction, so that turns are no events."""
        return self.pull_left == self.pull_right


def absorber(par: Sequence[Number]) -> Law:
    """Return the law for amplitude, restitution, friction, gravity, mass ratio, frequency."""
    C, r, mu, g, eps, omega = par[:6]
    one = 1.0 + 0.0 * eps
    return cavity([C, r, r, mu, mu, g, eps, omega, 0.0 * eps, one, one])


def cavity(par: Sequence[Number]) -> Law:
    """Return the law for amplitude, restitutions, frictions, gravity, mass ratio, frequency, slope, distances of the walls."""
    C, r_left, r_right, mu_left, mu_right, g, eps, omega, slope, left, right = par[:11]
    whole, cosine, zero = 1.0 + eps, np.cos(slope), 0.0 * omega
    free = Response(C, zero, zero, 1.0 * omega)  # prescribed motion C sin Psi
    return Law(
        omega, whole * mu_left * g * cosine, whole * mu_right * g * cosine, whole * g * np.sin(slope),
        r_left, r_right, left, -right, free, free, zero, zero, zero, zero, prescribed=True,
    )  # fmt: skip


def coupled(par: Sequence[Number]) -> Law:
    """Return the law for forcing, frequency, damping, mass ratio, restitution, friction, gravity, excitation, slope."""
    G, omega, damping, eps, r, mu, g, chi, slope = par[:9]
    a, drag, force = mu * g * np.cos(slope), eps * damping, eps * G
    one = 1.0 + 0.0 * eps
    slide, stuck = (_response(mass, force, chi, drag, omega) for mass in (one, 1.0 + eps))
    return Law(
        omega, a, a, g * np.sin(slope), r, r, one, -one,
        slide, stuck, eps, force, chi * drag * omega, drag, prescribed=False,
    )  # fmt: skip


def _response(mass: Number, force: Number, chi: Number, damping: Number, omega: Number) -> Response:
    """Return the response of a mass to the moving base: infinite at an undamped resonance; beta is NaN if it is overdamped."""
    drag, stiffness = damping * omega, 1.0 - mass * omega * omega
    scale = force / (stiffness * stiffness + drag * drag)
    X, Y = scale * (stiffness + chi * drag * drag), scale * drag * (chi * stiffness - 1.0)
    unforced = np.real(force) == 0.0
    alpha = 0.5 * damping / mass
    square = 1.0 / mass - alpha * alpha
    beta = np.sqrt(where(np.real(square) > 0.0, square, np.nan * square))
    return Response(
        where(unforced & ~np.isfinite(X), 0.0 * force, X),
        where(unforced & ~np.isfinite(Y), 0.0 * force, Y),
        alpha,
        beta,
    )


LawOf = Callable[[Sequence[Number]], Law]
"""A machine's parameters in the order of its table -> the numbers of its equations."""
DRIVEN = frozenset({"coupled"})
"""Machines whose cavity is an oscillator."""
LAWS: dict[str, LawOf] = {"absorber": absorber, "cavity": cavity, "coupled": coupled}
