"""Why no branch goes on at a border of a declared machine: what vanishes there, and where simulation goes from it."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbits.contacts.letters import HIT, STICK
from orbits.declared.attractor import attracted
from orbits.declared.orbit import DeclaredOrbit
from orbits.flows.page.cycle_equations import DeclaredSystem
from orbits.flows.page.margins import border_kind, per_node
from orbits.flows.page.stepper import SimulationError, Stepper
from orbits.machines.page.names import described

BESIDE = 1e-6  # of the parameter, from where simulation is asked
SLOW = 1e-3  # of the fastest impact's speed, or of the longest flight
VANISHING = 1e-9  # margins smaller than this are those of the border itself

PILING = "impacts on {contact} fall together: beyond the border infinitely many pile up, which simulation follows to their end and no finite word describes"
SLOWER = "an impact on {contact} with {speed:.1e} of the fastest one's speed comes before it: motions between its border and this one cannot be resolved"
FADING = "a stick of {contact} that lasts {length:.1e} of the longest flight is about to vanish as well: motions between the two borders cannot be resolved"
NONE = "no motion that goes on from this one was found, neither by the rules of {contact} nor by simulation"


def dead_end(problem: DeclaredSystem, point: Any) -> str:
    """A sentence that says why no motion was found on the other side of a border."""
    index = int(point.margin_index)
    u, p = np.asarray(point.u, dtype=float), float(point.value)
    orbit = DeclaredOrbit.of(problem, u, p)
    contacts = problem.machine.contacts
    place, column = divmod(index, per_node(len(contacts)))
    letter = orbit.word.letter(place) if len(orbit.word) else None
    own = column if column < len(contacts) else (0 if letter is None else letter.contact)
    if border_kind(problem.word, index) == "vanishing-event":
        return PILING.format(contact=described(contacts[own]))
    near = _nearly_vanishing(orbit)
    if near:
        return near
    return "; ".join([NONE.format(contact=described(contacts[own])), *_goes_to(problem, orbit, p)])


def _nearly_vanishing(orbit: DeclaredOrbit) -> str:
    """An event that nearly vanishes beside the one that does."""
    contacts = orbit.machine.contacts
    seen = {(m.kind, m.segment): m.value for m in orbit.margins}
    fastest = max((v for (kind, _), v in seen.items() if kind == "approach"), default=0.0)
    longest = max((v for (kind, _), v in seen.items() if kind == "duration"), default=0.0)
    for place in range(len(orbit.word)):
        letter = orbit.word.letter(place)
        speed, length = seen.get(("approach", place), np.inf), seen.get(("duration", place), np.inf)
        if letter.kind == HIT and VANISHING < speed < SLOW * fastest:
            return SLOWER.format(contact=described(contacts[letter.contact]), speed=speed / fastest)
        if letter.kind == STICK and VANISHING < length < SLOW * longest:
            return FADING.format(contact=described(contacts[letter.contact]), length=length / longest)
    return ""


def _goes_to(problem: DeclaredSystem, orbit: DeclaredOrbit, p: float) -> list[str]:
    """Where simulation from the border orbit goes, a little to both sides of it."""
    told = {}
    begin = float(orbit.nodes[0, 0]) if problem.forced else 0.0
    for side, name in ((1.0, "above"), (-1.0, "below")):
        stepper = Stepper(problem.machine, problem.values(p + side * BESIDE * max(1.0, abs(p))))
        try:
            stepper.start(orbit.nodes[0, 1:], begin, orbit.word.modes[0])
            found = attracted(stepper, 60, max(2 * problem.periods, 4), 0)
        except SimulationError as error:
            told[name] = f"is refused ({error})"
            continue
        if found.orbit is None:
            told[name] = ENDS[found.kind]
        elif found.orbit.word.canonical().events == orbit.word.canonical().events:
            told[name] = "stays with this word"
        else:
            told[name] = f"settles on {found.orbit.word.text or 'a motion without events'} elsewhere"
    if told["above"] == told["below"]:
        return [f"simulation {told['above']} on either side"]
    return [f"simulation {what} just {name} it" for name, what in told.items()]


ENDS = {
    "chatter": "goes to a motion on which impacts pile up",
    "rest": "comes to rest",
    "aperiodic": "goes to a motion without a period",
}
"""What simulation does where it finds no orbit."""
