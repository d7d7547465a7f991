"""What equilibria and cycles of a flow say of its attractors: by simulation, and of a solution that is known to be stable."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np


class Witnessed:
    """`witness` and `attractor` of equilibria and cycles."""

    flow: Any
    parameter: str
    parameters: Mapping[str, float]
    population: Any

    def witness(self, p: float, starts: int = 16) -> list[dict[str, Any]]:
        """What starts settle on: "word" and "kind" of each motion, "periods" of the forcing, and "u", the extremes of its states."""
        population = self.population(self.parameter)
        motions, _, _ = population.settle(population.starts(starts, 7, p), p)
        found = []
        for motion in motions:
            entry = {"word": motion.word or None, "periods": motion.periods, "kind": motion.kind}
            found.append(entry if motion.curve is None else {**entry, "u": _extremes(motion.curve)})
        return sorted(found, key=lambda one: (str(one["word"]), one["kind"], one.get("u", [])))

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """A stable solution as `witness` tells of it."""
        about: Any = self
        if about.spectrum == "flow":
            word, periods, curve = "equilibrium", 0, np.asarray(u, dtype=float)[None, : about.node]
        else:
            orbit = about.orbit(u, p)
            times = np.linspace(0.0, orbit.period, 1001)[:-1]
            word, periods = "cycle", about.rounds if about.field.forced else 0
            curve = orbit(times[:: len(times) // periods] if periods else times)
        return {"word": word, "periods": periods, "kind": "periodic", "u": _extremes(curve)}


def _extremes(curve: np.ndarray) -> list[float]:
    """Least and largest state along a motion: of two motions that are one they agree to a few digits."""
    return [float(x) for x in (*curve.min(axis=0), *curve.max(axis=0))]
