"""Orbit: one periodic motion, its nodes, its stability, and whether a machine can follow it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.cycles import measures as measuring
from orbits.cycles.identity import is_symmetric, root_orbit
from orbits.cycles.kernels import assemble
from orbits.cycles.margins import Margin, named_margins
from orbits.machines.base import Model
from orbits.problem import OrbitProblem
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.proofs import Proof

REAL = -1e-9  # margins down to this count as positive: a border orbit itself is real


@dataclass(frozen=True, eq=False, repr=False)
class Orbit:
    """A periodic orbit P_l^k.

    Attributes
    ----------
    model : Model
        The machine.
    word : Word
        Its events over the whole period.
    periods : int
        Forcing periods k.
    nodes : float array (L, n)
        Per event (Psi, B+) at impacts and (Psi, w) elsewhere; the coupled machine adds v and v'.
    params : float array (P,)
        Parameter vector, in the order of `model.parameter_names`.
    """

    model: Model
    word: Word
    periods: int
    nodes: np.ndarray = field(repr=False)
    params: np.ndarray = field(repr=False)

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value:.10g}" for name, value in self.parameters.items())
        return f"Orbit({self.model.name}, word={self.spelling!r}, periods={self.periods}, {values})"

    # ------------------------------------------------------------------ facts
    @property
    def spelling(self) -> str:
        """The word as people are told it: one spelling for one motion; `word` begins where the nodes do."""
        return self.word.spelled(self.model.has_mirror(self.params))

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name."""
        return dict(zip(self.model.parameter_names, (float(value) for value in self.params), strict=True))

    @property
    def impacts(self) -> int:
        """Impacts per period of the orbit."""
        return self.word.impacts

    @property
    def period(self) -> float:
        """Duration in dimensionless time tau."""
        return 2.0 * np.pi * self.periods / self.parameters["frequency"]

    @cached_property
    def symmetric(self) -> bool:
        """Whether the orbit equals its mirror image after half its period."""
        return self.model.has_mirror(self.params) and is_symmetric(self.word, self.periods, self.nodes)

    @cached_property
    def _examined(self) -> tuple[float, np.ndarray, np.ndarray]:
        problem = OrbitProblem(self.model, self.word, self.periods, self.model.default_parameter, self.params)
        if self.word.impact_free and self.symmetric:
            problem = problem.sibling(self.word, self.periods, symmetric=True)
        kernels = assemble(self.model)
        row = np.empty(2 * problem.n_multipliers + problem.n_margins)
        work = problem.workspace()
        value = problem.value(self.params)
        residual = kernels.examine(problem.data, problem.reduce(self.nodes), value, work, row)
        spectrum = row[: 2 * problem.n_multipliers : 2] + 1j * row[1 : 2 * problem.n_multipliers : 2]
        margins = row[2 * problem.n_multipliers :]
        return float(residual), problem.to_multipliers(spectrum), margins

    @property
    def residual(self) -> float:
        """Largest residual of the maps."""
        return self._examined[0]

    @property
    def multipliers(self) -> np.ndarray:
        """Multipliers of the period, complex, largest modulus first; an impact-free motion's trivial +1 is left out."""
        return self._examined[1]

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
        problem = OrbitProblem(
            self.model, self.word, self.periods, self.model.default_parameter, self.params, True
        )
        row = np.empty(2 * problem.n_multipliers + problem.n_margins)
        work = problem.workspace()
        assemble(self.model).examine(
            problem.data, problem.reduce(self.nodes), problem.value(self.params), work, row
        )
        return row[: 2 * problem.n_multipliers : 2] + 1j * row[1 : 2 * problem.n_multipliers : 2]

    @property
    def margins(self) -> list[Margin]:
        """Margins of admissibility, all positive for a real orbit."""
        return named_margins(self.word, self._examined[2])

    @property
    def margin(self) -> float:
        """The smallest margin."""
        return float(self._examined[2].min())

    @property
    def real(self) -> bool:
        """Whether a machine can follow the orbit: all margins positive."""
        return self.margin > REAL

    @property
    def stable(self) -> bool:
        """Whether all multipliers lie inside the unit circle."""
        return bool(np.all(np.abs(self.multipliers) < 1.0))

    def measure(self, name: str) -> float:
        """One measure of the orbit; names: `orbits.cycles.measures.COMMON` and the machine's own."""
        return float(self.measures(name)[name])

    def measures(self, *wanted: str) -> dict[str, float]:
        """Measures by name, all of them if none is named."""
        asked = wanted or measuring.names(self.model)
        values = measuring.measure(
            self.model, self.word, self.periods, self.nodes[None], self.params[None], list(asked)
        )
        return {name: float(value[0]) for name, value in values.items()}

    @cached_property
    def events(self) -> measuring.EventTable:
        """Positions and velocities at the events; arrays of shape (L,)."""
        table = measuring.event_table(self.model, self.word, self.nodes[None], self.params[None])
        return measuring.EventTable(**{name: values[0] for name, values in vars(table).items()})

    # ------------------------------------------------------------------ other descriptions of it
    def root(self) -> Orbit:
        """The shortest orbit of which this one is a repetition."""
        return Orbit(self.model, *root_orbit(self.word, self.periods, self.nodes), self.params)

    def repeat(self, times: int) -> Orbit:
        """The same orbit, written `times` times."""
        turn = 2.0 * np.pi * self.periods
        parts = []
        for copy in range(times):
            part = self.nodes.copy()
            part[:, 0] += copy * turn
            parts.append(part)
        return Orbit(
            self.model, self.word.repeat(times), self.periods * times, np.concatenate(parts), self.params
        )

    def mirror(self) -> Orbit:
        """The mirror image: L and R change places, half a forcing period later.

        Raises
        ------
        ValueError
            If it is no motion of this machine.
        """
        if not self.model.has_mirror(self.params):
            raise ValueError(
                f"the model {self.model.name!r} has no mirror symmetry with these parameters: the image of "
                f"{self.word.text!r} is not one of its orbits"
            )
        nodes = -self.nodes
        nodes[:, 0] = self.nodes[:, 0] + np.pi
        return Orbit(self.model, self.word.mirror(), self.periods, nodes, self.params)

    def rotate(self, places: int) -> Orbit:
        """The same orbit, read from the event `places` further on."""
        n = len(self.word)
        nodes = np.roll(self.nodes, -places, axis=0)
        turns = np.arange(n) + places
        nodes[:, 0] += (turns // n) * 2.0 * np.pi * self.periods
        return Orbit(self.model, self.word.rotate(places), self.periods, nodes, self.params)

    # ------------------------------------------------------------------ towards continuation
    def problem(self, parameter: str | None = None, symmetric: bool | None = None) -> OrbitProblem:
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
        return OrbitProblem(self.model, self.word, self.periods, parameter, self.params, half)

    def seed(self, problem: OrbitProblem) -> tuple[np.ndarray, float]:
        """Unknowns and parameter value of this orbit in `problem`."""
        return problem.reduce(self.nodes), problem.value(self.params)

    # ------------------------------------------------------------------ seeing and proving
    def sample(self, points: int = 400) -> dict[str, np.ndarray]:
        """Positions and velocities over one period; see `orbits.cycles.sampling.sample`."""
        from orbits.cycles.sampling import sample

        return sample(self, points)

    def replay(self) -> float:
        """Largest deviation of the event-driven simulation from the orbit over one period; see `orbits.simulation.deviation`."""
        from orbits.simulation.deviation import replay_error

        return replay_error(self)

    def prove(self, bits: int | None = None, **parameters: Any) -> Proof:
        """Prove that the orbit exists, is real or virtual, stable or unstable; see `orbits.proofs.subjects.of_orbit`."""
        from orbits.proofs.subjects import of_orbit

        return of_orbit(self, bits, **parameters)

    def plot(self, **options: Any) -> Any:
        """Phase portrait and time history; see `orbits.plots.portrait.portrait`."""
        from orbits.plots.portrait import portrait

        return portrait(self, **options)

    def scene(self, points: int = 120) -> dict[str, Any]:
        """The orbit as plain numbers for a page that draws it; see `orbits.plots.scene.scene`."""
        from orbits.plots.scene import scene

        return scene(self, points)

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
