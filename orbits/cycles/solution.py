"""A cycle seen through its equations: residual, multipliers, margins, measures."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from orbits.cycles import measures as measuring
from orbits.cycles.claim import Claim
from orbits.cycles.cycle import Cycle
from orbits.cycles.deviation import replay_error
from orbits.flows.native.cycle_equations import equations
from orbits.flows.native.sampling import PER_PERIOD, positions, sample
from orbits.words.margins import Margin, approaches_of, margin_units, named_margins

TOLERANCE = 1e-12  # of Newton's method, in the unknowns


@dataclass(frozen=True, eq=False, repr=False)
class Solution(Claim, Cycle):
    """A cycle that is claimed to solve its equations: how well, how stable, and whether a machine can follow it."""

    @cached_property
    def _examined(self) -> tuple[float, np.ndarray, np.ndarray]:
        half = self.word.impact_free and self.symmetric and len(self.word) > 0
        system = equations(
            self.model, self.word, self.periods, self.model.default_parameter, self.params, half
        )
        residual, spectrum, margins = _examined(system, self.nodes)
        return residual, system.to_multipliers(spectrum), margins

    @property
    def half_multipliers(self) -> np.ndarray:
        """Multipliers of the half map (half a period, then the mirror) of a symmetric orbit.

        +1 is a fold, -1 a symmetry breaking; the multipliers of the period are their squares.

        Raises
        ------
        ValueError
            If the orbit is not symmetric.
        """
        if not self.symmetric:
            raise ValueError(f"the orbit {self.word.text!r} is not symmetric, so it has no half map")
        parameter = self.model.default_parameter
        system = equations(self.model, self.word, self.periods, parameter, self.params, symmetric=True)
        _, spectrum, _ = _examined(system, self.nodes)
        return spectrum

    @property
    def margins(self) -> list[Margin]:
        """Margins of admissibility, none negative for a real orbit; in the units of the nodes."""
        own = self._examined[2]  # of half a symmetric motion without impacts
        units = margin_units(self.word, self.model.natural_units(self.params))
        return named_margins(self.word, own * units[: own.size])

    @property
    def approaches(self) -> np.ndarray:
        """The margins of the impacts, their speeds, in units of the machine's own size."""
        return approaches_of(self.word, self._examined[2])

    @property
    def relative_margins(self) -> list[Margin]:
        """The same in units of the machine's own size."""
        return named_margins(self.word, self._examined[2])

    def measures(self, *wanted: str) -> dict[str, float]:
        """Measures by name, all of them if none is named."""
        asked = wanted or measuring.names(self.model)
        values = measuring.measure(
            self.model, self.word, self.periods, self.nodes[None], self.params[None], list(asked)
        )
        return {name: float(value[0]) for name, value in values.items()}

    # ------------------------------------------------------------------ seeing it move
    def sample(self, points: int = 400) -> dict[str, np.ndarray]:
        """Positions and velocities over one period; see `orbits.flows.native.sampling.sample`."""
        return sample(self, points)

    @property
    def track(self) -> np.ndarray:
        """w at equal phases of the forcing; see `orbits.flows.native.sampling.positions`."""
        return self.positions(PER_PERIOD)

    def positions(self, instants: int) -> np.ndarray:
        """The same at so many phases of each period, kept: distances to several other orbits ask for it."""
        known = vars(self).setdefault("_tracks", {})
        if instants not in known:
            known[instants] = positions(self, instants)
        return known[instants]

    def repeat(self, times: int) -> Self:
        """The same orbit, written `times` times."""
        found = super().repeat(times)
        known = vars(self).get("_tracks", {})
        vars(found)["_tracks"] = {instants: np.tile(track, times) for instants, track in known.items()}
        return found

    def replay(self) -> float:
        """Largest deviation of the event-driven simulation from the orbit over one period; see `orbits.cycles.deviation`."""
        return replay_error(self, lambda: (self._examined[2], self.multipliers))


def _examined(system: Any, nodes: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Residual, multipliers of the closure map and margins of a cycle in its equations."""
    count = 2 * system.n_multipliers
    row = np.empty(count + system.n_margins)
    value = system.value(system.params)
    residual = system.kernels.examine(system.data, system.reduce(nodes), value, system.scratch, row)
    return float(residual), row[:count:2] + 1j * row[1:count:2], row[count:]
