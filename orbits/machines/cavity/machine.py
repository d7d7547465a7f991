"""The cavity: a mass with dry friction between two unlike walls, on a slope, shaken harmonically."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any, ClassVar

import numpy as np

from orbits.machines.cavity.rest import InclinedRest
from orbits.machines.cavity.shaken import Shaken
from orbits.machines.parameters import NOT_NEGATIVE, POSITIVE, RESTITUTION, SLOPE, Parameter, ParameterError
from orbits.machines.rest import Rest
from orbits.words import Word

PAIRS = {
    "restitution": ("restitution_left", "restitution_right"),
    "friction": ("friction_left", "friction_right"),
}
"""Names that stand for both sides at once."""


@dataclass(frozen=True, kw_only=True)
class Cavity(Shaken):
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

    name: ClassVar[str] = "cavity"
    rest: ClassVar[Rest] = InclinedRest()
    table: ClassVar[tuple[Parameter, ...]] = (
        Parameter("amplitude", "amplitude of v", NOT_NEGATIVE, "C", "b", 0.55),
        Parameter("restitution_left", "Newton's coefficient of the left wall", RESTITUTION, "r_L", "", 0.76),
        Parameter(
            "restitution_right", "Newton's coefficient of the right wall", RESTITUTION, "r_R", "", 0.76
        ),
        Parameter("friction_left", "Coulomb coefficient to the left wall", NOT_NEGATIVE, r"\mu_L", "", 0.5),
        Parameter("friction_right", "Coulomb coefficient to the right wall", NOT_NEGATIVE, r"\mu_R", "", 0.5),
        Parameter("gravity", "g / (b omega_0^2)", NOT_NEGATIVE, r"\tilde g", "b omega_0^2", 0.211),
        Parameter(
            "mass_ratio", "absorber's mass over the oscillator's", NOT_NEGATIVE, r"\varepsilon", "", 0.006
        ),
        Parameter("frequency", "excitation frequency", POSITIVE, r"\Omega", "omega_0", 1.0),
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
        for both, sides in PAIRS.items():
            given = [side for side in sides if getattr(self, side) is not None]
            if getattr(self, both) is not None and given:
                raise ParameterError(
                    f"{both} = {getattr(self, both):g} and {given[0]} = {getattr(self, given[0]):g} are both given: give {both} for "
                    f"both sides, or {sides[0]} and {sides[1]}"
                )
            if getattr(self, both) is None and len(given) < 2:
                missing = next(side for side in sides if side not in given)
                raise ParameterError(
                    f"{missing if given else both} is missing: give {both} for both sides, or {sides[0]} and {sides[1]}"
                )

    @property
    def kernels(self) -> ModuleType:
        from orbits.machines.cavity import maps

        return maps

    @classmethod
    def stepper(cls) -> ModuleType:
        from orbits.machines.cavity import stepper

        return stepper

    # ------------------------------------------------------------------ parameters for both sides at once
    @property
    def _together(self) -> dict[str, str]:
        """Each side that is given together with the other one, and the name they share."""
        return {
            side: both for both, sides in PAIRS.items() if getattr(self, both) is not None for side in sides
        }

    def vector(self, values: Mapping[str, Any] | None = None) -> np.ndarray:
        given = dict(values or {})
        for both, sides in PAIRS.items():
            shared = given.pop(both, getattr(self, both))
            if shared is not None:
                given = dict.fromkeys(sides, shared) | given
        return super().vector(given)

    @property
    def amount_names(self) -> tuple[str, ...]:
        shared = self._together
        return tuple(dict.fromkeys(shared.get(name, name) for name in self.parameter_names))

    def amounts(self, params: np.ndarray) -> np.ndarray:
        shared, names = self._together, self.amount_names
        places = [names.index(shared.get(name, name)) for name in self.parameter_names]
        return np.array([params[places.index(k)] for k in range(len(names))])

    def path(self, name: str, params: np.ndarray) -> np.ndarray:
        self.place_of(name)
        shared = self._together
        path = np.zeros((2, params.size))
        path[:, [shared.get(other, other) == name for other in self.parameter_names]] = 1.0
        return path

    @property
    def law(self) -> np.ndarray:
        shared, names = self._together, self.amount_names
        if not shared:
            return super().law
        law = np.zeros((len(names) + 1, len(self.parameter_names)))
        law[0] = 1.0
        for j, name in enumerate(self.parameter_names):
            law[names.index(shared.get(name, name)) + 1, j] = 1.0
        return law

    # ------------------------------------------------------------------ mechanics
    def has_mirror(self, params: np.ndarray, varying: str | None = None) -> bool:
        """Level, and with one coefficient of restitution and of friction; what varies must keep it so."""
        value = dict(zip(self.parameter_names, (float(number) for number in params)))
        if value["slope"] != 0.0 or any(value[left] != value[right] for left, right in PAIRS.values()):
            return False
        return varying not in ("slope", *(side for pair in PAIRS.values() for side in pair))

    @classmethod
    def friction_acceleration(cls, params: np.ndarray) -> float:
        """The larger of the two directions' (1 + eps) mu g cos(slope)."""
        return float(cls._normal(params) * max(cls.column(params, side) for side in PAIRS["friction"]))

    @classmethod
    def _normal(cls, params: np.ndarray) -> Any:
        eps, g = cls.column(params, "mass_ratio"), cls.column(params, "gravity")
        return (1.0 + eps) * g * cls.upright(params)

    @classmethod
    def friction_loss(cls, steps: np.ndarray, params: np.ndarray) -> np.ndarray:
        left, right = (cls.column(params, side)[:, None] for side in PAIRS["friction"])
        force = np.where(steps > 0.0, left, right) * np.abs(steps)
        return force.sum(axis=1) * cls._normal(params) / (1.0 + cls.column(params, "mass_ratio"))

    @classmethod
    def walls(cls, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return cls.column(params, "distance_left"), -cls.column(params, "distance_right")

    @classmethod
    def restitutions(cls, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return cls.column(params, "restitution_left"), cls.column(params, "restitution_right")

    # ------------------------------------------------------------------ starts
    def start_nodes(self, word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]:
        """The bounce off one wall on a slope without friction, `R` (or `L` for a negative slope).

        Over k forcing periods, T = 2 pi k/Omega: B+ = -b T/2 and C Omega cos Psi = -(1 - r)/(1 + r) b T/2.
        """
        if not word.frictionless or word.events not in (("R",), ("L",)):
            return
        value = dict(zip(self.parameter_names, (float(number) for number in params)))
        b = (1.0 + value["mass_ratio"]) * value["gravity"] * np.sin(value["slope"])
        r = value["restitution_right" if word.events == ("R",) else "restitution_left"]
        half, speed = np.pi * periods / value["frequency"], value["amplitude"] * value["frequency"]
        cosine = -(1.0 - r) / (1.0 + r) * b * half
        if (b > 0.0) != (word.events == ("R",)) or abs(cosine) > speed:
            return
        for sign in (-np.sign(b), np.sign(b)):  # where the table brakes the more the later it is hit: stable
            yield np.array([[sign * np.arccos(cosine / speed) % (2.0 * np.pi), -b * half]])

    def random_start(
        self, params: np.ndarray, generator: np.random.Generator, size: float = 1.0
    ) -> dict[str, float]:
        start = super().random_start(params, generator)
        left, right = (float(wall) for wall in self.walls(params))
        size = min(max(left, -right), 10.0 * min(left, -right))  # a wall out of reach is no measure
        low, high = max(right, -size), min(left, size)
        start["w"] = 0.5 * (low + high) + 0.5 * (high - low) * start["w"]
        return start
