"""The flow of the built-in machines: closed forms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.motions import BAND, SILENT
from orbits.flows.native import cycle_equations, measures, sampling, vanishing
from orbits.flows.protocol import Census, Motion
from orbits.machines.base import Model
from orbits.machines.events import events_of
from orbits.settings import SIMULATING
from orbits.words import Word

if TYPE_CHECKING:
    pass


class NativeFlow:
    """See `orbits.flows.protocol`; a node is (Psi, B+) at an impact, (Psi, w) elsewhere, and what the machine adds."""

    angles = measures.ANGLES
    points, sample = staticmethod(sampling.points), staticmethod(sampling.sample)
    equations = staticmethod(cycle_equations.equations)
    in_units, measures = staticmethod(measures.gauged), staticmethod(measures.measure)
    placed, vanishing = staticmethod(vanishing.placed), staticmethod(vanishing.vanishing)
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

    def loose(self, model: Model, word: Word) -> tuple[int, ...]:
        """The position, where no wall is hit."""
        return (1,) if word.impact_free and len(word) else ()

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
        """As the machine says."""
        return model.measure_names

    def default_measure(self, model: Model) -> str:
        """As the machine says."""
        return model.default_measure

    def simulated_names(self, model: Model) -> tuple[str, ...]:
        """Of the reduced model the squared amplitude of its cavity's motion stands for the oscillator's."""
        speeds = ("max_abs_w", "impact_speed", "impacts_per_period")
        return ("max_abs_q1", *speeds, *BAND, SILENT) if model.moving_cavity else ("C2", *speeds)

    def swept(self, model: Model) -> tuple[str, ...]:
        """As the machine says."""
        return (model.default_measure,)

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

    def restitution(self, motion: Motion[Model], place: int) -> float:
        """Newton's coefficient of the wall that is hit."""
        return float(motion.model.restitutions(motion.params)[motion.word.letter(place).contact])

    def without_events(self, motion: Motion[Model]) -> None:
        """That is the absorber at rest, whose border has rules of its own."""
