"""Why no branch goes on at a border: what vanishes there, and where simulation goes from it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.attractors.search import goes_on
from orbits.borders.neighbours import parameter_unit
from orbits.contacts.letters import HIT, SLIP, STICK, TURN
from orbits.flows.catalogue import simulator_of
from orbits.flows.protocol import SimulationError
from orbits.machines.base import Model
from orbits.orbit import Orbit
from orbits.protocol import CycleProblem
from orbits.settings import BORDERING, EVENTS
from orbits.starts.find import polish
from orbits.words.margins import border_kind, place_of

if TYPE_CHECKING:
    from orbits.protocol import BorderPoint


UNKNOWN = (
    "no motion that goes on from this one was found, neither by the rules of {contact} nor by simulation"
)
ENDS = {
    "chatter": "goes to a motion on which impacts pile up",
    "rest": "comes to rest",
    "stuck": "comes to rest",
    "aperiodic": "goes to a motion without a period",
}
"""What simulation does where it finds no orbit."""
TRANSIENT = 60  # forcing periods, or events of a self-excited motion


def dead_end(problem: CycleProblem, point: BorderPoint) -> str:
    """A sentence that says why no motion was found on the other side of a border."""
    u, p = np.asarray(point.u, dtype=float), float(point.value)
    orbit = problem.orbit(u, p)
    if not orbit.word.modes:
        if _gives_way_one_way(orbit):
            return "friction gives way in one direction only: the absorber creeps along the cavity until a wall stops it"
        return UNKNOWN.format(contact="the contacts")
    index = point.margin_index
    contact = "the contacts" if index is None else _contact(orbit, int(index))
    if index is not None and border_kind(orbit.word, int(index)) == "vanishing-event":
        return (
            f"impacts on {contact} fall together: beyond the border infinitely many pile up, which simulation follows to their end "
            "and no finite word describes"
        )
    near = _nearly_vanishing(orbit)
    return near or "; ".join([UNKNOWN.format(contact=contact), *_goes_to(problem, orbit, p)])


def _contact(orbit: Orbit, index: int) -> str:
    """The contact that a margin watches, in words."""
    word = orbit.word
    place, watched = place_of(word, index)
    if watched < 0:
        watched = word.letter(place).contact if len(word) else 0
    return word.alphabet.contacts[watched].described


def _nearly_vanishing(orbit: Orbit) -> str:
    """What else is about to vanish beside that which does; empty where nothing is."""
    margins, word = orbit.relative_margins, orbit.word
    speeds = [m.value for m in margins if m.kind == "approach" and BORDERING.shown < m.value < BORDERING.slow]
    turns = [k for k in range(len(word)) if word.letter(k).kind == TURN]
    gaps = [
        m.value
        for m in margins
        if m.kind == "wall" and m.segment in turns and BORDERING.shown < m.value < BORDERING.slow
    ]
    if speeds:
        return (
            f"impacts pile up at a wall: of those before it the slowest has {min(speeds):.1e} of the machine's own speed, and a further "
            "one cannot be distinguished from rest"
        )
    if gaps:
        return (
            f"turns pile up at a wall: of those before it the nearest keeps {min(gaps):.1e} of the machine's own length, and a further "
            "one cannot be distinguished from contact"
        )
    seen = {(m.kind, m.segment): m.value for m in margins}
    for place in range(len(word)):
        pair = seen.get(("duration", place), np.inf), seen.get(("stick", place), np.inf)
        if word.letter(place).kind == STICK and min(pair) > BORDERING.shown and max(pair) < BORDERING.slow:
            return (
                f"a stick that lasts {pair[0]:.1e} of the machine's own time, with {pair[1]:.1e} of its friction in reserve, is about to "
                "vanish as well: motions between the two borders cannot be resolved"
            )
    return ""


def _goes_to(problem: CycleProblem, orbit: Orbit, p: float) -> list[str]:
    """Where simulation from the border orbit goes, a little to both sides of it."""
    # import of own names

    told = {}
    for side, name in ((1.0, "above"), (-1.0, "below")):
        found, kind = settled(
            orbit, problem.values(p + side * BORDERING.away[0] * parameter_unit(problem, p))
        )
        if found is None:
            told[name] = ENDS.get(kind, kind)
        elif found.word.canonical().events == orbit.word.canonical().events:
            told[name] = "stays with this word"
        else:
            told[name] = f"settles on {found.spelling or 'a motion without events'} elsewhere"
    if told["above"] == told["below"]:
        return [f"simulation {told['above']} on either side"]
    return [f"simulation {what} just {name} it" for name, what in told.items()]


def piled_up(orbit: Orbit, approaches: np.ndarray) -> bool:
    """Whether a border orbit with these speeds of impacts has one that is too slow, once the wall has sent it back, to see what the next ones do."""
    hits = [place for place in range(len(orbit.word)) if orbit.word.letter(place).kind == HIT]
    return any(
        speed > BORDERING.shown and orbit.flow.restitution(orbit, place) * speed < BORDERING.unresolved
        for speed, place in zip(approaches.tolist(), hits)
    )


def _gives_way_one_way(orbit: Orbit) -> bool:
    """Whether friction and slope hold the absorber better one way than the other."""
    model = orbit.model
    if not isinstance(model, Model):
        return False
    left, right = model.rest.reserves(orbit.params)
    return bool(abs(left - right) > EVENTS.zero * model.friction_acceleration(orbit.params))


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
