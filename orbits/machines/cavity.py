"""The cavity: a mass with dry friction between two different walls, on a slope, shaken harmonically.

Each side has its own restitution and friction. One name can stand for both sides: `restitution` for `restitution_left` and
`restitution_right`. If a machine is given by the common name, both sides vary together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from orbits.machines.base import Model
from orbits.machines.parameters import (
    AMPLITUDE,
    FREQUENCY,
    GRAVITY,
    MASS_RATIO,
    NOT_NEGATIVE,
    POSITIVE,
    RESTITUTION,
    SLOPE,
    Parameter,
    ParameterError,
)
from orbits.words import Word

PAIRS = {name: (f"{name}_left", f"{name}_right") for name in ("restitution", "friction")}
"""Common names of both sides, and the names of each side."""


@dataclass(frozen=True, kw_only=True)
class Cavity(Model):
    """A reduced absorber with two different walls and gravity along the cavity.

    ``w'' = -C Omega^2 sin(Psi) - (1 + eps) g sin(slope) - s (1 + eps) mu_s g cos(slope),   -distance_right <= w <= distance_left``,

    with s the sign of w', ``mu_+`` = `friction_left` (sliding to the left wall), ``mu_-`` = `friction_right`, and w'+ = -r w'- with the
    restitution of the wall that is hit. Level and with equal sides it is `orbits.Absorber`; level and with different distances it is
    symmetric about the middle between the walls. Steep, without friction and with a left wall out of reach it is a ball that
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
        Angle of the cavity in radians, from -pi/2 to pi/2; if positive, gravity pulls towards the right wall, w = -1.
    distance_left, distance_right : float
        Distances of the walls from w = 0, above 0, in units of b.
    mass_ratio : float
        eps = m / M >= 0.
    frequency : float
        Omega > 0, excitation frequency over omega_0.
    contact_time : float, optional
        Duration of an impact in 1/omega_0, only for the measure ``peak_force``; the motion does not depend on it.

    Raises
    ------
    ParameterError
        For impossible values; the message names field, value and remedy.

    Notes
    -----
    The absorber's absolute motion is q2'' = g sin(slope) + s mu g cos(slope), and w = v - (1 + eps) q2 with v = C sin(Omega tau)
    about its position of rest.
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
        AMPLITUDE,
        Parameter("restitution_left", "Newton's coefficient of the left wall", RESTITUTION, "r_L", "", 0.76),
        Parameter(
            "restitution_right", "Newton's coefficient of the right wall", RESTITUTION, "r_R", "", 0.76
        ),
        Parameter("friction_left", "Coulomb coefficient to the left wall", NOT_NEGATIVE, r"\mu_L", "", 0.5),
        Parameter("friction_right", "Coulomb coefficient to the right wall", NOT_NEGATIVE, r"\mu_R", "", 0.5),
        GRAVITY,
        MASS_RATIO,
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

    def _check_together(self) -> None:
        for common, sides in PAIRS.items():
            given = [side for side in sides if getattr(self, side) is not None]
            if getattr(self, common) is not None and given:
                raise ParameterError(
                    f"{common} = {getattr(self, common):g} and {given[0]} = {getattr(self, given[0]):g} are both given: give {common} for "
                    f"both sides, or {sides[0]} and {sides[1]}"
                )
            if getattr(self, common) is None and len(given) < 2:
                missing = next(side for side in sides if side not in given)
                raise ParameterError(
                    f"{missing if given else common} is missing: give {common} for both sides, or {sides[0]} and {sides[1]}"
                )

    def vector(self, values: Mapping[str, Any] | None = None) -> np.ndarray:
        given = dict(values or {})
        for common, sides in PAIRS.items():
            shared = given.pop(common, getattr(self, common))
            if shared is not None:
                given = dict.fromkeys(sides, shared) | given
        return super().vector(given)

    # ------------------------------------------------------------------ what varies
    @property
    def _amount_of(self) -> list[str]:
        """Name of the amount behind each number: the common name of both sides if they are given together, else its own name."""
        shared = {
            side: common
            for common, sides in PAIRS.items()
            if getattr(self, common) is not None
            for side in sides
        }
        return [shared.get(name, name) for name in self.parameter_names]

    @property
    def amount_names(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(self._amount_of))

    def amounts(self, params: np.ndarray) -> np.ndarray:
        places = self._amount_of
        return np.array([params[places.index(name)] for name in self.amount_names])

    @property
    def law(self) -> np.ndarray:
        places, names = self._amount_of, self.amount_names
        if len(names) == len(places):
            return super().law
        powers = [[float(place == name) for place in places] for name in names]
        return np.array([[1.0] * len(places), *powers])

    # ------------------------------------------------------------------ starts
    def start_nodes(self, word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]:
        """Yield nodes of the bounce off one wall on a slope without friction, `R` (or `L` for a negative slope), in closed form.

        Over k forcing periods, T = 2 pi k/Omega: B+ = -b T/2 and C Omega cos Psi = -(1 - r)/(1 + r) b T/2.
        """
        if not word.frictionless or word.events not in (("R",), ("L",)):
            return
        value = self.named(params)
        b = (1.0 + value["mass_ratio"]) * value["gravity"] * np.sin(value["slope"])
        r = value["restitution_right" if word.events == ("R",) else "restitution_left"]
        half, speed = np.pi * periods / value["frequency"], value["amplitude"] * value["frequency"]
        cosine = -(1.0 - r) / (1.0 + r) * b * half
        if (b > 0.0) != (word.events == ("R",)) or abs(cosine) > speed:
            return
        for sign in (
            -np.sign(b),
            np.sign(b),
        ):  # first the stable one: the later the table is hit, the more it brakes
            yield np.array([[sign * np.arccos(cosine / speed) % (2.0 * np.pi), -b * half]])
