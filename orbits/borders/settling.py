"""Where simulation goes from a border orbit when a parameter moves on."""

from __future__ import annotations

import numpy as np

from orbits.attractors.page import attracted
from orbits.attractors.recurrence import settle
from orbits.contacts.letters import SLIP
from orbits.flows.page.stepper import Stepper
from orbits.flows.protocol import SimulationError
from orbits.machines.catalogue import stepper
from orbits.machines.states import state_of
from orbits.orbit import Orbit
from orbits.starts.find import polish

TRANSIENT = 60  # forcing periods, or events of a self-excited motion


def settled(orbit: Orbit, params: np.ndarray) -> tuple[Orbit | None, str]:
    """The periodic motion that simulation reaches from an orbit's first event with other parameters; else None and the kind of motion, or why not."""
    word = orbit.word
    place = next((i for i in range(len(word)) if word.letter(i).kind != SLIP), 0)
    most = max(2 * orbit.periods, 4)
    if orbit.model.flow == "page":
        run = Stepper(orbit.model, params)
        try:
            run.start(
                orbit.nodes[place, 1:],
                float(orbit.nodes[place, 0]) if orbit.forced else 0.0,
                word.mode(place),
            )
            found = attracted(run, TRANSIENT, most, 0)
        except SimulationError as error:
            return None, f"is refused ({error})"
        return found.orbit, found.kind
    engine = stepper(orbit.model.name)
    state = state_of(engine, params, int(word.codes[place]), int(word.modes[place]), orbit.nodes[place])
    left, right = engine.walls(params)
    state[1] = np.clip(state[1], right, left)
    attractor = settle(orbit.model, engine, params, state, float(TRANSIENT), most, 1e-6, 0)
    if attractor.word is None or not attractor.nodes.size:
        return None, attractor.kind
    return polish(Orbit.of(attractor.cycle)), attractor.kind
