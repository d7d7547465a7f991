"""The numbers of the equations of motion, from the parameters of each built-in machine.

Between two events q1, the cavity, is a harmonic of the forcing and a damped oscillation of its own, and q2, the absorber, a parabola:

    q1'' + drag q1' + q1 = e + eps drag-share - eps q2'',    q2'' = s friction + lean,    w = q1 - q2,    v = q1 + eps q2,

where the cavity rides on an oscillator (`coupled`), counted from where both rest. A cavity that is shaken (`absorber`, `cavity`) is the same with
eps = 0: q1 = v = C sin Psi whatever the absorber does, and q2 counted (1 + eps) times. So w'' = v'' - (1 + eps)(s friction + lean) for all.

Parameters may be numbers or arrays, real or complex (`orbits.machines.reference.maps` differentiates by complex steps).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np


class Response(NamedTuple):
    """The forced harmonic X sin Psi + Y cos Psi of q1, and decay rate and angular frequency of its own oscillation."""

    X: Any
    Y: Any
    alpha: Any
    beta: Any


class Law(NamedTuple):
    """The numbers of the equations of motion.

    omega: the forcing's frequency. friction_left, friction_right: accelerations of q2 by friction while sliding to either wall; lean: by the
    slope. Restitution and place of either wall. slide, stuck: response of q1 while the absorber slides and while it sticks. eps: the absorber's
    share of the oscillator's mass. force, base: amplitudes of the excitation's sine, and of its cosine over that. drag: eps lambda.
    """

    omega: Any
    friction_left: Any
    friction_right: Any
    lean: Any
    restitution_left: Any
    restitution_right: Any
    left: Any
    right: Any
    slide: Response
    stuck: Response
    eps: Any = 0.0
    force: Any = 0.0
    base: Any = 0.0
    drag: Any = 0.0
    prescribed: bool = True

    @property
    def whole(self) -> Any:
        """1 + eps."""
        return 1.0 + self.eps

    @property
    def amplitude(self) -> Any:
        """C, of a cavity that is shaken."""
        return self.slide.X

    @property
    def pull_left(self) -> Any:
        """q2'' while sliding to the left wall."""
        return self.friction_left + self.lean

    @property
    def pull_right(self) -> Any:
        """q2'' while sliding to the right wall."""
        return self.lean - self.friction_right

    @property
    def frictionless(self) -> bool:
        """Whether turns are no events."""
        return self.pull_left == self.pull_right

    @property
    def strength(self) -> Any:
        """Amplitude of the excitation."""
        return abs(self.force) * np.sqrt(1.0 + self.base * self.base)


def absorber(par: Any) -> Law:
    """Amplitude, restitution, friction, gravity, mass ratio, frequency."""
    C, r, mu, g, eps, omega = par[:6]
    a = (1.0 + eps) * mu * g
    free = Response(C, 0.0, 0.0, 1.0)
    return Law(omega, a, a, 0.0, r, r, 1.0, -1.0, free, free)


def cavity(par: Any) -> Law:
    """Amplitude, restitutions, frictions, gravity, mass ratio, frequency, slope, distances of the walls."""
    C, r_left, r_right, mu_left, mu_right, g, eps, omega, slope, left, right = par[:11]
    cosine, weight = np.cos(slope), (1.0 + eps) * g
    free = Response(C, 0.0, 0.0, 1.0)
    to_left, to_right = (1.0 + eps) * mu_left * g * cosine, (1.0 + eps) * mu_right * g * cosine
    return Law(omega, to_left, to_right, weight * np.sin(slope), r_left, r_right, left, -right, free, free)


def coupled(par: Any) -> Law:
    """Forcing, frequency, damping, mass ratio, restitution, friction, gravity, excitation, slope."""
    G, omega, damping, eps, r, mu, g, chi, slope = par[:9]
    a, drag, force = mu * g * np.cos(slope), eps * damping, eps * G
    slide, stuck = (_response(mass, force, chi, drag, omega) for mass in (1.0, 1.0 + eps))
    base = chi * drag * omega
    return Law(
        omega,
        a,
        a,
        g * np.sin(slope),
        r,
        r,
        1.0,
        -1.0,
        slide,
        stuck,
        eps,
        force,
        base,
        drag,
        prescribed=False,
    )


def _response(mass: Any, force: Any, chi: Any, damping: Any, omega: Any) -> Response:
    """Of a mass to the moving base: infinite at an undamped resonance; beta is not a number where it is overdamped."""
    drag, stiffness = damping * omega, 1.0 - mass * omega * omega
    scale = force / (stiffness * stiffness + drag * drag)
    X, Y = scale * (stiffness + chi * drag * drag), scale * drag * (chi * stiffness - 1.0)
    still = np.real(force) == 0.0
    alpha = 0.5 * damping / mass
    square = 1.0 / mass - alpha * alpha
    beta = np.sqrt(np.where(np.real(square) > 0.0, square, np.nan))
    return Response(
        np.where(still & ~np.isfinite(X), 0.0, X), np.where(still & ~np.isfinite(Y), 0.0, Y), alpha, beta
    )


DRIVEN = frozenset({"coupled"})
"""Machines whose cavity rides on an oscillator."""
LAWS: dict[str, Callable[[Any], Law]] = {"absorber": absorber, "cavity": cavity, "coupled": coupled}
