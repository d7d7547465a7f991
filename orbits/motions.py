"""What the problem of an orbit says of its machine's motions, by simulation: sections, and what is settled on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.modulation import BAND
from orbits.flows.protocol import Equations, Flow
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.machines.varying import Varying
    from orbits.orbit import Orbit
    from orbits.simulation.section import Section


class Simulated:
    """Answers of a problem that knows its machine, word, periods, equations and parameter vector."""

    model: Varying
    flow: Flow
    word: Word
    periods: int
    parameter: str
    equations: Equations

    def values(self, p: float) -> np.ndarray:
        """The parameter vector at parameter value `p`."""
        raise TypeError("a problem says what its parameters are")

    def orbit(self, u: np.ndarray, p: float) -> Orbit:
        """A solution as an orbit."""
        raise TypeError("a problem says what its orbits are")

    def simulated_attractors(self, p: float, starts: int = 5) -> list[dict[str, Any]]:
        """What the machine settles on at a parameter value, simulated from rest and from random starts.

        Returns
        -------
        list of dict
            "word" (None where there is none), "periods" and "kind" of each motion and "share" of the starts that lead to it, sorted; of
            one that does not recur "modulation" and its band, too (see `contvines.shared.modulation`), where it has one.
        """
        from orbits.attractors.observation import modulated
        from orbits.attractors.search import met

        found: dict[tuple[str, int, str], dict[str, Any]] = {}
        motions = list(met(self.model, self.values(p), starts, 7, max_period=12, patience=1))
        for motion, measures in motions:
            text = None if motion.word is None else _canonical_text(motion.word)
            key = (text or "", int(motion.periods), motion.kind)
            if key not in found:
                found[key] = {"word": text, "periods": key[1], "kind": motion.kind, "share": 0.0}
                if modulation := modulated(motion, measures):
                    found[key] |= {"modulation": modulation, **{name: measures[name] for name in BAND}}
            found[key]["share"] += 1
        for one in found.values():
            one["share"] /= len(motions)
        return [found[key] for key in sorted(found)]

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """A stable motion as `simulated_attractors` lists it."""
        kind = self.flow.kind(self.orbit(u, p))
        return {"word": _canonical_text(self.word), "periods": self.periods, "kind": kind}

    def section(self, p: float) -> Section:
        """Its motions by simulation, once per period of the cycle.

        Raises
        ------
        ValueError
            For the absorber at rest, which has no event to begin with.
        """
        if not len(self.equations.unit):
            raise ValueError("the absorber that never slides has no section")
        from orbits.simulation.runs import simulator_of
        from orbits.simulation.section import Section

        simulator, unit = simulator_of(self.model, self.values(p)), self.equations.unit[0]
        return Section(simulator, self.word, self.periods, unit, self.model.place_of(self.parameter))


def _canonical_text(word: Word) -> str:
    """One spelling for one motion, mirror images apart."""
    return word.canonical().spelled()
