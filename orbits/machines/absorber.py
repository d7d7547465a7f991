"""The reduced absorber: a mass with dry friction in a cavity that is shaken harmonically."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from contvines.shared.near_names import hinting
from orbits.machines.base import Model
from orbits.machines.closed_forms import absorber as closed_forms
from orbits.machines.parameters import (
    AMPLITUDE,
    FREQUENCY,
    FRICTION,
    GRAVITY,
    MASS_RATIO,
    RESTITUTION,
    Parameter,
)
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
        Duration of an impact in 1/omega_0, which moves nothing: with it orbits have the measure ``peak_force``.

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
        return closed_forms.start_nodes(word, periods, params)

    @hinting
    def symmetric_orbit(self, amplitude: float, stable: bool = True):
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
        from orbits.orbit import Orbit

        params = self.vector({"amplitude": amplitude})
        nodes = closed_forms.symmetric_nodes(params, stable)
        return Orbit(self, Word.parse("LR", frictionless=self.frictionless(params)), 1, nodes, params)
