"""The reduced absorber: a mass with dry friction in a cavity that is shaken harmonically."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any, ClassVar

import numpy as np

from contvines.shared.near_arguments import hinting
from orbits.machines.absorber.closed_forms import sliding_nodes, stick_slip_nodes, symmetric_nodes
from orbits.machines.absorber.rest import LevelRest
from orbits.machines.cavity.shaken import Shaken
from orbits.machines.parameters import NOT_NEGATIVE, POSITIVE, RESTITUTION, Parameter, ParameterError
from orbits.machines.rest import Rest
from orbits.words import Word


@dataclass(frozen=True, kw_only=True)
class Absorber(Shaken):
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
    rest: ClassVar[Rest] = LevelRest()
    closed_words: ClassVar[tuple[str, ...]] = ("LR", "tt", "susu")
    table: ClassVar[tuple[Parameter, ...]] = (
        Parameter("amplitude", "amplitude of v", NOT_NEGATIVE, "C", "b", 0.55),
        Parameter("restitution", "Newton's coefficient of the walls", RESTITUTION, "r", "", 0.76),
        Parameter("friction", "Coulomb coefficient", NOT_NEGATIVE, r"\mu", "", 0.5),
        Parameter("gravity", "g / (b omega_0^2)", NOT_NEGATIVE, r"\tilde g", "b omega_0^2", 0.211),
        Parameter(
            "mass_ratio", "absorber's mass over the oscillator's", NOT_NEGATIVE, r"\varepsilon", "", 0.006
        ),
        Parameter("frequency", "excitation frequency", POSITIVE, r"\Omega", "omega_0", 1.0),
    )

    @property
    def kernels(self) -> ModuleType:
        from orbits.machines.absorber import maps

        return maps

    @classmethod
    def stepper(cls) -> ModuleType:
        from orbits.machines.absorber import stepper

        return stepper

    def start_nodes(self, word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]:
        if periods != 1:
            return
        events = "".join(word.events)
        try:
            if events in ("LR", "RL"):
                for stable in (True, False):
                    nodes = symmetric_nodes(params, stable)
                    yield nodes if events == "LR" else np.array([nodes[1], nodes[0] + [2.0 * np.pi, 0.0]])
            elif events == "tt":
                yield sliding_nodes(params, word.modes[0])
            elif events == "susu" and word.modes[1] == -word.modes[3]:
                yield stick_slip_nodes(params, word.modes[1])
        except ParameterError:
            return

    @hinting
    def symmetric_orbit(self, amplitude: float, stable: bool = True) -> Any:
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
        from orbits.words import Word

        params = self.vector({"amplitude": amplitude})
        nodes = symmetric_nodes(params, stable)
        return Orbit(self, Word.parse("LR", frictionless=self.frictionless(params)), 1, nodes, params)
