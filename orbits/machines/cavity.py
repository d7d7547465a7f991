"""The cavity: a mass with dry friction between two unlike walls, on a slope, shaken harmonically."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from orbits.machines.closed_forms import cavity as closed_forms
from orbits.machines.parameters import (
    FREQUENCY,
    GRAVITY,
    NOT_NEGATIVE,
    POSITIVE,
    RESTITUTION,
    SLOPE,
    Parameter,
)
from orbits.machines.sided import Sided
from orbits.words import Word


@dataclass(frozen=True, kw_only=True)
class Cavity(Sided):
    """A reduced absorber with two unlike walls and gravity along the cavity.

    ``w'' = -C Omega^2 sin(Psi) - (1 + eps) g sin(slope) - s (1 + eps) mu_s g cos(slope),   -distance_right <= w <= distance_left``,

    with s the sign of w', ``mu_+`` = `friction_left` (sliding to the left wall), ``mu_-`` = `friction_right`, and w'+ = -r w'- with the
    restitution of the wall that is hit. Level and with equal sides this is `orbits.Absorber`, level and with unlike distances it is
    symmetric about the middle between the walls. Steep, without friction and with the left wall out of reach it is a ball that
    bounces on a sinusoidal table.

    Parameters
    ----------
    restitution : float
        Newton's coefficient of both walls; or, instead of it,
    restitution_left, restitution_right : float
        that of each wall, 0 < r <= 1.
    friction : float
        Coulomb coefficient mu >= 0 for both directions; or, instead of it,
    friction_left, friction_right : float
        that of sliding to the left and to the right wall.
    gravity : float
        g / (b omega_0^2) >= 0.
    slope : float
        Angle of the cavity in radians, from -pi/2 to pi/2; positive pulls towards the right wall, w = -1.
    distance_left, distance_right : float
        Of the walls from w = 0, above 0, in units of b.
    mass_ratio : float
        eps = m / M >= 0.
    frequency : float
        Omega > 0, excitation frequency over omega_0.
    contact_time : float, optional
        Duration of an impact in 1/omega_0, which moves nothing: with it orbits have the measure ``peak_force``.

    Raises
    ------
    ParameterError
        For values that make no sense; the sentence names field, value and way out.

    Notes
    -----
    The absorber's absolute motion is q2'' = g sin(slope) + s mu g cos(slope), and w = v - (1 + eps) q2 with v = C sin(Omega tau)
    about its place of rest.
    """

    restitution: float | None = None
    restitution_left: float | None = None
    restitution_right: float | None = None
    friction: float | None = None
    friction_left: float | None = None
    friction_right: float | None = None
    gravity: float
    slope: float = 0.0
    distance_left: float = 1.0
    distance_right: float = 1.0
    mass_ratio: float = 0.0
    frequency: float = 1.0
    contact_time: float | None = field(default=None, repr=False)

    name = "cavity"
    default_parameter = "amplitude"
    driven_by: ClassVar[str] = "amplitude"
    table: ClassVar[tuple[Parameter, ...]] = (
        Parameter("amplitude", "amplitude of v", NOT_NEGATIVE, "C", "b", 0.55),
        Parameter("restitution_left", "Newton's coefficient of the left wall", RESTITUTION, "r_L", "", 0.76),
        Parameter(
            "restitution_right", "Newton's coefficient of the right wall", RESTITUTION, "r_R", "", 0.76
        ),
        Parameter("friction_left", "Coulomb coefficient to the left wall", NOT_NEGATIVE, r"\mu_L", "", 0.5),
        Parameter("friction_right", "Coulomb coefficient to the right wall", NOT_NEGATIVE, r"\mu_R", "", 0.5),
        GRAVITY,
        Parameter(
            "mass_ratio", "absorber's mass over the oscillator's", NOT_NEGATIVE, r"\varepsilon", "", 0.006
        ),
        FREQUENCY,
        Parameter("slope", "angle of the cavity", SLOPE, r"\alpha", "rad", 0.1),
        Parameter("distance_left", "of the left wall from w = 0", POSITIVE, "d_L", "b", 1.0),
        Parameter("distance_right", "of the right wall from w = 0", POSITIVE, "d_R", "b", 1.0),
    )
    settable: ClassVar[tuple[Parameter, ...]] = (
        *table,
        Parameter("restitution", "Newton's coefficient of both walls", RESTITUTION, "r", "", 0.76),
        Parameter("friction", "Coulomb coefficient of both directions", NOT_NEGATIVE, r"\mu", "", 0.5),
    )

    def start_nodes(self, word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]:
        return closed_forms.start_nodes(word, periods, self.named(params))
