"""The reduced absorber: a mass with dry friction in a cavity that is shaken harmonically."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from orbits.machines.base import NOT_NEGATIVE, POSITIVE, RESTITUTION, Model

if TYPE_CHECKING:
    from orbits.orbit import Orbit


@dataclass(frozen=True, kw_only=True)
class Absorber(Model):
    """A vibro-impact absorber whose cavity moves as v = C sin(Omega tau).

    w'' = -C Omega^2 sin(Psi) - (1 + eps) mu g sign(w'),   |w| <= 1,   w'+ = -r w'- at the walls.

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

    Notes
    -----
    The amplitude C (in units of b) belongs to each orbit, not to the machine. Source: Youssef, Karoui, Leine, the
    model of the impact map section.
    """

    restitution: float
    friction: float
    gravity: float
    mass_ratio: float = 0.0
    frequency: float = 1.0

    name: ClassVar[str] = "absorber"
    node: ClassVar[int] = 2
    default_parameter: ClassVar[str] = "amplitude"
    parameter_names: ClassVar[tuple[str, ...]] = (
        "amplitude",
        "restitution",
        "friction",
        "gravity",
        "mass_ratio",
        "frequency",
    )
    limits: ClassVar[Mapping] = {
        "amplitude": NOT_NEGATIVE,
        "restitution": RESTITUTION,
        "friction": NOT_NEGATIVE,
        "gravity": NOT_NEGATIVE,
        "mass_ratio": NOT_NEGATIVE,
        "frequency": POSITIVE,
    }

    def __post_init__(self) -> None:
        self._check_fields()

    @property
    def kernels(self) -> ModuleType:
        from orbits.machines.absorber import maps

        return maps

    def symmetric_orbit(self, amplitude: float, stable: bool = True) -> Orbit:
        """The symmetric orbit `LR` with two impacts per period, in closed form.

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
        from orbits.machines.absorber.closed_forms import symmetric_nodes
        from orbits.orbit import Orbit
        from orbits.words import Word

        params = self.vector({"amplitude": amplitude})
        nodes = symmetric_nodes(params, stable)
        return Orbit(
            self, Word.parse("LR", frictionless=self.friction_acceleration(params) == 0.0), 1, nodes, params
        )

    def orbit(
        self,
        word: str,
        periods: int = 1,
        guess: Sequence[Sequence[float]] | np.ndarray | None = None,
        **parameters: float,
    ) -> Orbit:
        """Solve for the orbit with this word; see `orbits.starts.find.find`."""
        from orbits.starts.find import find

        return find(self, word, periods, guess, parameters)
