"""Orbit: one periodic motion, its nodes, its stability, and whether a machine can follow it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from contvines.shared.near_arguments import hinting
from orbits.cycles.solution import Solution
from orbits.doors import above


@dataclass(frozen=True, eq=False, repr=False)
class Orbit(Solution):
    """A periodic orbit P_l^k as users hold it; the attributes are those of `orbits.cycles.cycle.Cycle`."""

    # ------------------------------------------------------------------ towards continuation
    @hinting
    def problem(self, parameter: str | None = None, symmetric: bool | None = None) -> Any:
        """The orbit's word as a continuation problem against `parameter`.

        Parameters
        ----------
        parameter : str, optional
            Default: `model.default_parameter`.
        symmetric : bool, optional
            Solve on half the word; default: whether the orbit is symmetric.
        """
        parameter = parameter or self.model.default_parameter
        lasting = self.symmetric and self.model.has_mirror(self.params, parameter)
        half = lasting if symmetric is None else symmetric
        made = above("OrbitProblem")
        return made(self.model, self.word, self.periods, parameter, self.params, half)

    def seed(self, problem: Any) -> tuple[np.ndarray, float]:
        """Unknowns and parameter value of this orbit in `problem`."""
        return problem.reduce(self.nodes), problem.value(self.params)

    # ------------------------------------------------------------------ seeing and proving
    def prove(self, bits: int | None = None, **parameters: Any) -> Any:
        """Prove that the orbit exists, is real or virtual, stable or unstable; see `orbits.proofs.subjects.of_orbit`."""
        return above("of_orbit")(self, bits, **parameters)

    def _repr_html_(self) -> str:
        return above("orbit_page")(self)

    def plot(self, **options: Any) -> Any:
        """Phase portrait and time history; see `orbits.plots.portrait.portrait`."""
        return above("portrait")(self, **options)

    def scene(self, points: int = 120) -> dict[str, Any]:
        """The orbit as plain numbers for a page that draws it; see `orbits.plots.scene.scene`."""
        return above("scene")(self, points)

    def to_dict(self) -> dict[str, Any]:
        """The orbit as JSON: events, multipliers, margins."""
        table = self.events
        long, fast = (float(self.model.gauge(kind, self.params)) for kind in ("length", "velocity"))
        nodes = []
        for i, letter in enumerate(self.word.events):
            entry = {
                "event": letter,
                "phase": float(table.phase[i]),
                "B_pre": float(table.B_pre[i]) * fast,
                "B_post": float(table.B_post[i]) * fast,
                "w": float(table.w[i]) * long,
                "w_rate": float(table.rate_post[i]) * fast,
            }
            for name in self.model.node_names[2:]:
                entry[name] = float(getattr(table, name)[i]) * (fast if name.endswith("rate") else long)
            nodes.append(entry)
        return {
            "word": self.spelling,
            "events": "".join(self.word.events),
            "periods": self.periods,
            "impacts": self.impacts,
            "symmetric": self.symmetric,
            **self.model.described(self.params),
            "nodes": nodes,
            "multipliers": [[float(value.real), float(value.imag)] for value in self.multipliers],
            "margins": [{"kind": m.kind, "segment": m.segment, "value": m.value} for m in self.margins],
            "real": self.real,
            "residual": self.residual,
        }
