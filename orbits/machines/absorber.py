"""The reduced absorber: a mass with dry friction in a cavity that is shaken harmonically, and its exact orbits.

With a = (1 + eps) mu g, R = (1 - r)/(1 + r), H = (pi/2) a / Omega^2 and the absorber's mean velocity
B = Omega beta + pi a / (2 Omega) after an impact, the symmetric orbit with two impacts per period satisfies

    C sin Psi = 1 - (pi/2) beta,    C cos Psi = R beta + H,    C^2 = (1 - pi beta/2)^2 + (R beta + H)^2.

This is the slow invariant manifold of Youssef, Karoui, Leine (`orbits.theory.manifolds`) with beta for B and H for h; it is exact at any
Omega.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from contvines.shared.near_names import hinting
from contvines.shared.numbers import ROUNDED
from orbits.machines.base import Model
from orbits.machines.parameters import (
    AMPLITUDE,
    FREQUENCY,
    FRICTION,
    GRAVITY,
    MASS_RATIO,
    RESTITUTION,
    Parameter,
    ParameterError,
)
from orbits.settings import FORMULAS
from orbits.theory import manifolds
from orbits.words import Word


@dataclass(frozen=True, kw_only=True)
class Absorber(Model):
    """A vibro-impact absorber whose cavity moves as v = C sin(Omega tau).

    ``w'' = -C Omega^2 sin(Psi) - (1 + eps) mu g sign(w'),   |w| <= 1,   w'+ = -r w'-`` at the walls.

    Parameters
    ----------
    restitution : float
        Newton's coefficient r of the walls, 0 < r <= 1.
    friction : float
        Coulomb coefficient mu >= 0.
    gravity : float
        g / (b omega_0^2) >= 0, with the cavity's half-width b and the oscillator's frequency omega_0.
    mass_ratio : float
        eps = m / M >= 0.
    frequency : float
        Omega > 0, excitation frequency over omega_0.
    contact_time : float, optional
        Duration of an impact in 1/omega_0, only for the measure ``peak_force``; the motion does not depend on it.

    Notes
    -----
    The amplitude C (in units of b) is given with each orbit, not with the machine. Source: Youssef, Karoui, Leine, the
    model of the impact map section.
    """

    restitution: float
    friction: float
    gravity: float
    mass_ratio: float = 0.0
    frequency: float = 1.0
    contact_time: float | None = field(default=None, repr=False)

    name = "absorber"
    default_parameter = "amplitude"
    driven_by: ClassVar[str] = "amplitude"
    closed_words: ClassVar[tuple[str, ...]] = ("LR", "tt", "susu")
    table: ClassVar[tuple[Parameter, ...]] = (
        AMPLITUDE,
        Parameter("restitution", "Newton's coefficient of the walls", RESTITUTION, "r", "", 0.76),
        FRICTION,
        GRAVITY,
        MASS_RATIO,
        FREQUENCY,
    )

    def start_nodes(self, word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]:
        """Yield the nodes of the words `LR`, `RL`, `tt` and `susu` in closed form."""
        if periods != 1:
            return
        events = "".join(word.events)
        try:
            if events in ("LR", "RL"):
                for stable in (True, False):
                    nodes = symmetric_nodes(params, stable)
                    yield nodes if events == "LR" else np.array([nodes[1], nodes[0] + [2.0 * np.pi, 0.0]])
            elif events == "tt":
                yield sliding_nodes(params, int(word.mode_codes[0]))
            elif events == "susu" and word.mode_codes[1] == -word.mode_codes[3]:
                yield stick_slip_nodes(params, int(word.mode_codes[1]))
        except ParameterError:
            return

    @hinting
    def symmetric_orbit(self, amplitude: float, stable: bool = True):
        """Return the symmetric orbit `LR` with two impacts per period, in closed form.

        Parameters
        ----------
        amplitude : float
            C, at or above the fold of the symmetric orbits.
        stable : bool
            True for the branch of larger impact velocity, which is stable above the fold.

        Raises
        ------
        ParameterError
            If there is no symmetric orbit at this amplitude.
        """
        from orbits.orbit import Orbit

        params = self.vector({"amplitude": amplitude})
        nodes = symmetric_nodes(params, stable)
        return Orbit(self, Word.parse("LR", frictionless=self.frictionless(params)), 1, nodes, params)


def _loss_and_level(params: np.ndarray) -> tuple[float, float]:
    """Return R and H of the manifold that contains the orbits; B of the literature is beta here."""
    _, r, mu, g, eps, omega = (float(value) for value in params[:6])
    return float(manifolds.impact_loss(r)), float(manifolds.friction_level(mu, g, eps)) / omega**2


def symmetric_nodes(params: np.ndarray, stable: bool = True) -> np.ndarray:
    """Return nodes (Psi, B+) at L and R of the symmetric orbit, shape (2, 2).

    Parameters
    ----------
    params : float array (6,)
        Amplitude, restitution, friction, gravity, mass_ratio, frequency.
    stable : bool
        The larger (True) or the smaller of the two mean velocities.

    Raises
    ------
    ParameterError
        If the amplitude is below the fold.
    """
    C, omega = float(params[0]), float(params[5])
    R, H = _loss_and_level(params)
    least = float(manifolds.activation(R, H).amplitude)
    if least * (1.0 - FORMULAS.zero) > C:
        raise ParameterError(
            f"amplitude = {C:g} has no symmetric orbit with two impacts per period: it begins at {least:.10g}"
        )
    beta = float(manifolds.velocity_at(max(C, least), R, H, 1 if stable else -1))
    psi = float(np.arctan2(1.0 - 0.5 * np.pi * beta, R * beta + H)) % (2.0 * np.pi)
    speed = omega * (beta + H)  # B+ = Omega beta + pi a/(2 Omega)
    # impact on the left wall: signs of C sin Psi and C cos Psi for w = +1 and motion to the right
    return np.array([[psi, speed], [psi + np.pi, -speed]])


def sliding_nodes(params: np.ndarray, mode: int = 1) -> np.ndarray:
    """Return nodes (Psi, w) at the turns of pure sliding `tt` about the middle, shape (2, 2).

    From w' = 0 at both turns, half a period apart: C cos Psi = -s H, and the turning points are w = -+ sqrt(C^2 - H^2).

    Parameters
    ----------
    params : float array (6,)
    mode : int
        Direction s of the slide after the first turn.

    Raises
    ------
    ParameterError
        If the shaking is too weak to slide.
    """
    C, H = float(params[0]), _loss_and_level(params)[1]
    if C <= H:
        raise ParameterError(f"amplitude = {C:g} is too small for pure sliding: it needs more than {H:.10g}")
    psi = float(np.arctan2(-mode * np.sqrt(C**2 - H**2), -mode * H)) % (2.0 * np.pi)
    w = -mode * np.sqrt(C**2 - H**2)
    return np.array([[psi, w], [psi + np.pi, -w]])


def stick_slip_nodes(params: np.ndarray, mode: int = 1) -> np.ndarray:
    """Return nodes (Psi, w) of the symmetric stick-slip motion `ss` (events s, u, s, u) about the middle, shape (4, 2).

    A slip starts at C Omega^2 sin Psi = -m a; the slide after it ends at the next zero of w'.

    Parameters
    ----------
    params : float array (6,)
    mode : int
        Direction m of the first slip.

    Raises
    ------
    ParameterError
        If the absorber never slips, or slides without sticking.
    """
    from scipy.optimize import root_scalar

    C, _, mu, g, eps, omega = (float(value) for value in params[:6])
    a = (1.0 + eps) * mu * g
    if C * omega**2 <= a:
        raise ParameterError(
            f"amplitude = {C:g} never beats friction: stick-slip needs more than {a / omega**2:.10g}"
        )
    low = float(manifolds.sliding_bounds(_loss_and_level(params)[1])[0])
    if low < C:
        raise ParameterError(f"amplitude = {C:g} slides without sticking: stick-slip ends at {low:.10g}")
    slip = (np.pi if mode > 0 else 0.0) + float(np.arcsin(a / (C * omega**2)))

    def rate(psi: float) -> float:
        return mode * C * omega * (np.cos(psi) - np.cos(slip)) - a * (psi - slip) / omega

    # w' rises until the shaking is weaker than friction (at slip + pi - 2 asin(..)), then falls through 0
    left, right = (
        2.0 * np.pi * (mode > 0) + (np.pi if mode < 0 else 0.0) - float(np.arcsin(a / (C * omega**2))),
        slip + np.pi,
    )
    stick = root_scalar(rate, bracket=(left, right), xtol=ROUNDED).root
    d = (stick - slip) / omega
    path = C * (np.sin(stick) - np.sin(slip)) - C * omega * np.cos(slip) * d - mode * 0.5 * a * d**2
    return np.array(
        [
            [stick - np.pi, -0.5 * path],
            [slip, -0.5 * path],
            [stick, 0.5 * path],
            [slip + np.pi, 0.5 * path],
        ]
    )
