"""Exact orbits of the reduced absorber, and the amplitudes at which they begin and end.

With a = (1 + eps) mu g, R = (1 - r)/(1 + r), H = (pi/2) a / Omega^2 and the absorber's mean velocity
B = Omega beta + pi a / (2 Omega) after an impact, the symmetric orbit with two impacts per period obeys

    C sin Psi = 1 - (pi/2) beta,    C cos Psi = R beta + H,    C^2 = (1 - pi beta/2)^2 + (R beta + H)^2.

At Omega = 1 this is the slow invariant manifold of Youssef, Karoui, Leine; the other forms follow from the maps.
All functions broadcast over their arguments.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from orbits.machines.parameters import ParameterError
from orbits.settings import FORMULAS
from orbits.words import Word


def restitution_ratio(restitution: ArrayLike) -> np.ndarray:
    """R = (1 - r)/(1 + r)."""
    r = np.asarray(restitution, dtype=float)
    return (1.0 - r) / (1.0 + r)


def friction_number(
    friction: ArrayLike, gravity: ArrayLike, mass_ratio: ArrayLike, frequency: ArrayLike = 1.0
) -> np.ndarray:
    """H = (pi/2) (1 + eps) mu g / Omega^2; at Omega = 1 the h~ of the literature."""
    eps, omega = np.asarray(mass_ratio, dtype=float), np.asarray(frequency, dtype=float)
    return (
        0.5
        * np.pi
        * (1.0 + eps)
        * np.asarray(friction, dtype=float)
        * np.asarray(gravity, dtype=float)
        / omega**2
    )


def symmetric_square(beta: ArrayLike, R: ArrayLike, H: ArrayLike) -> np.ndarray:
    """C^2 of the symmetric orbit with reduced mean velocity beta."""
    beta, R, H = np.asarray(beta, dtype=float), np.asarray(R, dtype=float), np.asarray(H, dtype=float)
    return (1.0 - 0.5 * np.pi * beta) ** 2 + (R * beta + H) ** 2


def fold_beta(R: ArrayLike, H: ArrayLike) -> np.ndarray:
    """Reduced mean velocity at the fold of the symmetric orbits: (2 pi - 4 R H)/(pi^2 + 4 R^2)."""
    R, H = np.asarray(R, dtype=float), np.asarray(H, dtype=float)
    return (2.0 * np.pi - 4.0 * R * H) / (np.pi**2 + 4.0 * R**2)


def symmetry_breaking_beta(R: ArrayLike, H: ArrayLike) -> np.ndarray:
    """Reduced mean velocity at the symmetry breaking: (2 pi - 4 R H)/(pi^2 - 4)."""
    R, H = np.asarray(R, dtype=float), np.asarray(H, dtype=float)
    return (2.0 * np.pi - 4.0 * R * H) / (np.pi**2 - 4.0)


def fold_square(R: ArrayLike, H: ArrayLike) -> np.ndarray:
    """C^2 at the fold: the least amplitude with symmetric orbits."""
    return symmetric_square(fold_beta(R, H), R, H)


def symmetry_breaking_square(R: ArrayLike, H: ArrayLike) -> np.ndarray:
    """C^2 at the symmetry breaking of the symmetric orbits."""
    return symmetric_square(symmetry_breaking_beta(R, H), R, H)


def sliding_squares(H: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """C^2 between which pure sliding `tt` lasts: H^2 (1 + 4/pi^2), where it begins to stick, and 1 + H^2, where it grazes."""
    H = np.asarray(H, dtype=float)
    return H**2 * (1.0 + 4.0 / np.pi**2), 1.0 + H**2


def symmetric_nodes(params: np.ndarray, stable: bool = True) -> np.ndarray:
    """Nodes (Psi, B+) at L and R of the symmetric orbit, shape (2, 2).

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
    C, r, mu, g, eps, omega = (float(value) for value in params[:6])
    R = float(restitution_ratio(r))
    H = float(friction_number(mu, g, eps, omega))
    curvature = 0.25 * np.pi**2 + R**2
    least = float(fold_square(R, H))
    middle = float(fold_beta(R, H))
    if least * (1.0 - FORMULAS.zero) > C**2:
        raise ParameterError(
            f"amplitude = {C:g} has no symmetric orbit with two impacts per period: it begins at {np.sqrt(least):.10g}"
        )
    root = np.sqrt(max(C**2 - least, 0.0) / curvature)
    beta = middle + root if stable else middle - root
    psi = float(np.arctan2(1.0 - 0.5 * np.pi * beta, R * beta + H)) % (2.0 * np.pi)
    speed = omega * (beta + H)  # B+ = Omega beta + pi a/(2 Omega)
    # contact on the left: C sin Psi and C cos Psi with the signs of w = +1 and of a motion to the right
    return np.array([[psi, speed], [psi + np.pi, -speed]])


def sliding_nodes(params: np.ndarray, mode: int = 1) -> np.ndarray:
    """Nodes (Psi, w) at the turns of pure sliding `tt` about the middle, shape (2, 2).

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
    C, _, mu, g, eps, omega = (float(value) for value in params[:6])
    H = float(friction_number(mu, g, eps, omega))
    if C <= H:
        raise ParameterError(f"amplitude = {C:g} is too small for pure sliding: it needs more than {H:.10g}")
    psi = float(np.arctan2(-mode * np.sqrt(C**2 - H**2), -mode * H)) % (2.0 * np.pi)
    w = -mode * np.sqrt(C**2 - H**2)
    return np.array([[psi, w], [psi + np.pi, -w]])


def stick_slip_nodes(params: np.ndarray, mode: int = 1) -> np.ndarray:
    """Nodes (Psi, w) of the symmetric stick-slip motion `ss` (events s, u, s, u) about the middle, shape (4, 2).

    A slip starts where C Omega^2 sin Psi = -m a; the slide after it ends at the next zero of w' (bisection).

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
    C, _, mu, g, eps, omega = (float(value) for value in params[:6])
    a = (1.0 + eps) * mu * g
    if C * omega**2 <= a:
        raise ParameterError(
            f"amplitude = {C:g} never beats friction: stick-slip needs more than {a / omega**2:.10g}"
        )
    low, high = sliding_squares(friction_number(mu, g, eps, omega))
    if float(low) < C**2:
        raise ParameterError(
            f"amplitude = {C:g} slides without sticking: stick-slip ends at {np.sqrt(low):.10g}"
        )
    slip = (np.pi if mode > 0 else 0.0) + float(np.arcsin(a / (C * omega**2)))

    def rate(psi: float) -> float:
        return mode * C * omega * (np.cos(psi) - np.cos(slip)) - a * (psi - slip) / omega

    # w' rises until the shaking falls below friction (at slip + pi - 2 asin(..)), then falls through 0
    left, right = (
        2.0 * np.pi * (mode > 0) + (np.pi if mode < 0 else 0.0) - float(np.arcsin(a / (C * omega**2))),
        slip + np.pi,
    )
    for _ in range(200):
        middle = 0.5 * (left + right)
        if rate(middle) > 0.0:
            left = middle
        else:
            right = middle
    stick = 0.5 * (left + right)
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


def start_nodes(word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]:
    """Nodes of the words in closed form: `LR`, `RL`, `tt`, `susu`."""
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
