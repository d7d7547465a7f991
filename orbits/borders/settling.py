"""Where simulation goes from a border orbit when a parameter moves on."""

from __future__ import annotations

import numpy as np

from orbits.attractors.search import goes_on
from orbits.contacts.letters import SLIP
from orbits.flows.protocol import SimulationError
from orbits.orbit import Orbit
from orbits.simulation.runs import simulator_of
from orbits.starts.find import polish

TRANSIENT = 60  # forcing periods, or events of a self-excited motion


def settled(orbit: Orbit, params: np.ndarray) -> tuple[Orbit | None, str]:
    """The periodic motion that simulation reaches from an orbit's first event with other parameters; else None and the kind of motion, or why not."""
    word = orbit.word
    place = next((i for i in range(len(word)) if word.letter(i).kind != SLIP), 0)
    most = max(2 * orbit.periods, 4)
    simulator = simulator_of(orbit.model, params)
    try:
        simulator.begin(word.rotate(place), orbit.nodes[place])
        found = goes_on(simulator, TRANSIENT, most)
    except SimulationError as error:
        return None, f"is refused ({error})"
    if found.word is None or not len(found.found.nodes):
        return None, found.kind
    return polish(found.found), found.kind
