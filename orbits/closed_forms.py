"""Exact orbits of the reduced absorber, and the amplitudes at which they begin and end.

With a = (1 + eps) mu g, R = (1 - r)/(1 + r), H = (pi/2) a / Omega^2 and the absorber's mean velocity
B = Omega beta + pi a / (2 Omega) after an impact, the symmetric orbit with two impacts per period obeys

    C sin Psi = 1 - (pi/2) beta,    C cos Psi = R beta + H,    C^2 = (1 - pi beta/2)^2 + (R beta + H)^2.

At Omega = 1 this is the slow invariant manifold of Youssef, Karoui, Leine; the other forms follow from the maps.
All functions broadcast over their arguments.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from orbits.models.base import ParameterError


def restitution_ratio(restitution: ArrayLike) -> np.ndarray:
    """R = (1 - r)/(1 + r)."""
    r = np.asarray(restitution, dtype=float)
    return (1.0 - r) / (1.0 + r)


def friction_number(friction: ArrayLike, gravity: ArrayLike, mass_ratio: ArrayLike, frequency: ArrayLike = 1.0) -> np.ndarray:
    """H = (pi/2) (1 + eps) mu g / Omega^2; at Omega = 1 the h~ of the literature."""
    eps, omega = np.asarray(mass_ratio, dtype=float), np.asarray(frequency, dtype=float)
    return 0.5 * np.pi * (1.0 + eps) * np.asarray(friction, dtype=float) * np.asarray(gravity, dtype=float) / omega**2


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
    C, r, mu, g, eps, omega = (float(value) for value in params)
    R = float(restitution_ratio(r))
    H = float(friction_number(mu, g, eps, omega))
    curvature = 0.25 * np.pi**2 + R**2
    least = float(fold_square(R, H))
    middle = float(fold_beta(R, H))
    if C**2 < least:
        raise ParameterError(
            f"amplitude = {C:g} has no symmetric orbit with two impacts per period: it begins at {np.sqrt(least):.10g}"
        )
    root = np.sqrt(max(C**2 - least, 0.0) / curvature)
    beta = middle + root if stable else middle - root
    psi = float(np.arctan2(1.0 - 0.5 * np.pi * beta, R * beta + H)) % (2.0 * np.pi)
    speed = omega * (beta + H)  # B+ = Omega beta + pi a/(2 Omega)
    # contact on the left: C sin Psi and C cos Psi with the signs of w = +1 and of a motion to the right
    return np.array([[psi, speed], [psi + np.pi, -speed]])
