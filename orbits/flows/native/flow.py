"""The flow of the built-in machines: closed forms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.modulation import BAND, SILENT
from orbits.contacts.changes import Change
from orbits.flows.native import cycle_equations, measures, sampling, vanishing
from orbits.flows.native.cycle_equations import Equations
from orbits.flows.protocol import Census, Motion, Vanishing
from orbits.machines.base import Model
from orbits.machines.events import events_of
from orbits.settings import SIMULATING
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.flows.native.rest_equations import RestEquations


class NativeFlow:
    """See `orbits.flows.protocol`; a node is (Psi, B+) at an impact, (Psi, w) elsewhere, and what the machine adds."""

    angles = measures.ANGLES
    closed_form = True
    resolution = SIMULATING.one  # two borders whose values agree to 1e-12 may be 5e-6 apart

    def census(self, model: Model) -> Census:
        """Many at once, in closed form."""
        return Census(across=200, brief=(5, 48), price=1.0, longest=24, embedded=6)

    def coordinates(self, model: Model) -> tuple[str, ...]:
        """Position and velocity in the cavity, and of a machine with an oscillator those of the centre of mass."""
        return ("w", "w_rate", "v", "v_rate") if model.moving_cavity else ("w", "w_rate")

    def position_entries(self, model: Model) -> tuple[int, ...]:
        """w."""
        return (1,)

    def position_names(self, model: Model) -> tuple[str, ...]:
        """w."""
        return ("w",)

    def points(self, motion: Motion[Model]) -> np.ndarray:
        """Positions and velocities in the cavity, and those of the centre of mass."""
        return sampling.points(motion)

    def equations(
        self,
        model: Model,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool = False,
        units: tuple[float, float] | None = None,
    ) -> Equations | RestEquations:
        """In the native core, or its reference."""
        return cycle_equations.equations(model, word, periods, parameter, params, symmetric, units)

    def loose(self, model: Model, word: Word) -> tuple[int, ...]:
        """The position, where no wall is hit."""
        return (1,) if word.impact_free and len(word) else ()

    def sample(self, motion: Motion[Model], points: int) -> dict[str, np.ndarray]:
        """See `orbits.flows.native.sampling.sample`."""
        return sampling.sample(motion, points)

    def positions(self, motion: Motion[Model], instants: int) -> np.ndarray:
        """w; see `orbits.flows.native.sampling.positions`."""
        return sampling.positions(motion, instants)[:, None]

    def image(self, motion: Motion[Model]) -> np.ndarray:
        """Mirrored about the middle between the walls."""
        return motion.model.image(motion.word.codes, motion.nodes, motion.params)

    def strobed(self, motion: Motion[Model]) -> np.ndarray:
        """Nothing to be seen: at rest there are no unknowns."""
        return np.zeros((motion.periods + 1, 0))

    def measure_names(self, model: Model) -> tuple[str, ...]:
        """See `orbits.machines.measures`."""
        return measures.names(model)

    def default_measure(self, model: Model) -> str:
        """As the machine says."""
        return model.default_measure

    def measures(
        self,
        model: Model,
        word: Word,
        periods: int,
        nodes: np.ndarray,
        params: np.ndarray,
        wanted: Sequence[str],
    ) -> dict[str, np.ndarray]:
        """See `orbits.flows.native.measures`."""
        return measures.measure(model, word, periods, nodes, params, wanted)

    def simulated_names(self, model: Model) -> tuple[str, ...]:
        """Of the reduced model the squared amplitude of its cavity's motion stands for the oscillator's."""
        speeds = ("max_abs_w", "impact_speed", "impacts_per_period")
        return ("max_abs_q1", *speeds, *BAND, SILENT) if model.moving_cavity else ("C2", *speeds)

    def swept(self, model: Model) -> tuple[str, ...]:
        """As the machine says."""
        return (model.swept_measure,)

    def in_units(self, model: Model, params: np.ndarray, values: dict[str, float]) -> dict[str, float]:
        """See `orbits.flows.native.measures.gauged`."""
        return measures.gauged(model, params, values)

    def described(self, motion: Motion[Model]) -> dict[str, Any]:
        """Velocities and positions at the events, in the units that are shown."""
        model, table = motion.model, events_of(motion)
        long, fast = (float(model.gauge(kind, motion.params)) for kind in ("length", "velocity"))
        nodes = []
        for i, letter in enumerate(motion.word.events):
            entry = {
                "event": letter,
                "phase": float(table.phase[i]),
                "B_pre": float(table.B_pre[i]) * fast,
                "B_post": float(table.B_post[i]) * fast,
                "w": float(table.w[i]) * long,
                "w_rate": float(table.rate_post[i]) * fast,
            }
            for name in model.node_names[2:]:
                entry[name] = float(getattr(table, name)[i]) * (fast if name.endswith("rate") else long)
            nodes.append(entry)
        return {"events": "".join(motion.word.events), "nodes": nodes}

    def kind(self, motion: Motion[Model]) -> str:
        """Told by the events."""
        return "periodic" if motion.word.impacts else "sliding" if len(motion.word) else "stuck"

    def vanishing(self, motion: Motion[Model], index: int, unit: int) -> Vanishing | None:
        """See `orbits.flows.native.vanishing`."""
        return vanishing.vanishing(motion, index, unit)

    def placed(self, motion: Motion[Model], found: Vanishing, place: int, change: Change) -> np.ndarray:
        """See `orbits.flows.native.vanishing`."""
        return vanishing.placed(motion, found, place, change)

    def restitution(self, motion: Motion[Model], place: int) -> float:
        """Newton's coefficient of the wall that is hit."""
        return float(motion.model.restitutions(motion.params)[motion.word.letter(place).contact])

    def without_events(self, motion: Motion[Model]) -> None:
        """That is the absorber at rest, whose border has rules of its own."""
