"""Borders: points where a motion stops being physically possible, and the motions that continue from there.

`cross` finds the branches on the other side of a border; `dead_end` gives the reason if there are none. The local rules of `rewriting` propose
the new word; if they fail, the word is read from a simulation. A proposal is accepted only if its equations have a real solution next to the border
(`neighbours` solves with the size of the vanishing event held fixed) and the simulator follows it. `rounds` treats changes in some rounds of a
cycle only. The new word begins at the event that corresponds to the first one of the old word (`read_alike`), so that measures taken at the first
impact, and words in tables, do not jump along a chain of branches.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator
from itertools import chain, product
from typing import TYPE_CHECKING

import numpy as np

from orbits.attractors.search import goes_on
from orbits.borders.neighbours import BranchAtBorder, followed, margins_of, parameter_unit, placed, proposals
from orbits.borders.rounds import escapes
from orbits.contacts import HIT, SLIP, STICK, TURN
from orbits.cycle import canonical, size_of_one
from orbits.flows import simulator_of
from orbits.flows.equations import newton, solved_at
from orbits.flows.protocol import SimulationError
from orbits.machines.base import Model
from orbits.orbit import CLOSE, REAL, Orbit, distance, tends
from orbits.protocol import CycleProblem, Seed
from orbits.settings import BORDERING, EVENTS, SOLVING
from orbits.starts.find import StartError, find, polish
from orbits.words import approaches_of, border_kind, place_of

if TYPE_CHECKING:
    from orbits.protocol import BorderPoint


LONG_WORD = 60  # longest word, in characters, that a note shows
NEARER = (
    0.3,
    0.1,
    0.03,
    0.01,
)  # distances from the border, relative to that of a simulated orbit, at which the orbit is solved for again
UNKNOWN = (
    "no motion that goes on from this one was found, neither by the rules of {contact} nor by simulation"
)
ENDS = {
    "chatter": "goes to a motion on which impacts pile up",
    "rest": "comes to rest",
    "stuck": "comes to rest",
    "aperiodic": "goes to a motion without a period",
}
"""Description of a simulation that reaches no orbit, by kind of motion."""
TRANSIENT = 60  # forcing periods, or events of a self-excited motion


def cross(problem: CycleProblem, point: BorderPoint, every: bool = True) -> list[Seed]:
    """Find the branches on the other side of a border.

    Parameters
    ----------
    problem : CycleProblem
    point : special point
        With `u`, `value`, `tangent` and `margin_index`.
    every : bool
        Include orbits of less symmetry or longer period that leave at the border, even if other branches are found.

    Returns
    -------
    list of Seed
        Usually one; empty if neither the local rules nor the simulator find an orbit there.
    """
    if not problem.word.modes:
        return from_rest(problem, point)
    u, p = np.asarray(point.u, dtype=float), float(point.value)
    rest = to_rest(problem, point)
    before = problem.orbit(u, p)
    if rest or piled_up(before, approaches_of(problem.word, margins_of(problem, u, p))):
        return rest
    assert point.margin_index is not None  # the point lies at a border
    index, tangent_here = point.margin_index, np.asarray(point.tangent, dtype=float)
    nearby = _real_part(problem, u, p, tangent_here, index)
    old_side = 0.0 if nearby[0] is None else float(np.sign(nearby[0][1] - p))
    seeds = []
    # the simulation comes last: it runs only if no proposal is accepted
    border = placed(problem, u, p, index)
    rooms = chain.from_iterable(map(proposals, border.with_room()))
    for found, note in chain(proposals(border), rooms, _simulated(problem, u, p)):
        orbit = found.orbit()
        if not followed(orbit):
            continue
        simplest, persistence = _simplest(found, orbit), bool(np.sign(found.p - p) != old_side)
        kind = "persistence" if persistence else "nonsmooth fold"
        seeds.append(Seed(*simplest, "border", f"{note}: {kind}", persistence))
        if simplest is not found:
            seeds.extend(_simpler_continuations(simplest.problem, simplest.u, p))
        break
    if (every or not seeds) and len(problem.word):
        seeds += escapes(border, [placed(problem, *near, index) for near in nearby if near is not None])
    return [_with_word(read_alike(seed, before)) for seed in seeds]


def _with_word(seed: Seed) -> Seed:
    """Add the new word to the seed's note; of a long word, the number of its events."""
    text = seed.problem.spelling or "free of events"
    if len(text) > LONG_WORD:
        text = f"one of {len(seed.problem.word)} events"
    return seed._replace(note=f"{seed.note}, the word becomes {text}")


def _simplest(found: BranchAtBorder, orbit: Orbit) -> BranchAtBorder:
    """The same orbit in the smallest problem: as a shorter orbit if it repeats one, as a symmetric one if it is its own mirror image."""
    problem, root = found.problem, orbit.root()
    smallest = problem.sibling(root.word, root.periods, root.symmetric)
    if smallest.periods == problem.periods and smallest.symmetric == problem.symmetric:
        return found
    return BranchAtBorder(smallest, smallest.reduce(root.nodes), found.p, None)


def _simpler_continuations(problem: CycleProblem, u: np.ndarray, p: float) -> Iterator[Seed]:
    """Continuation of the simpler orbits (more symmetry, shorter period) on whose border a branch ends."""
    at_border, residual = solved_at(problem.equations, u, p)
    if not residual < SOLVING.residual:
        return
    index = int(np.argmin(np.abs(margins_of(problem, at_border, p))))
    for found, note in proposals(placed(problem, at_border, p, index)):
        if followed(found.orbit()):
            yield Seed(*found, "border", f"{note}: the branches meet at the border", False)
            return


def _real_part(
    problem: CycleProblem, u: np.ndarray, p: float, tangent: np.ndarray, index: int
) -> list[tuple[np.ndarray, float] | None]:
    """Solutions (u, p) on the branch's real side, at each of the distances `BORDERING.distances` from the border; None where Newton's method fails.

    Both directions are solved: if a stick vanishes in a flight, the branch turns back at the border, so that its tangent does not show the
    real side.
    """
    tangent = tangent / float(np.abs(tangent).max())
    sides, found = (1.0, -1.0), []
    for length in BORDERING.distances:
        best = None
        for side in sides:
            ahead, q = u + side * length * tangent[:-1], p + side * length * float(tangent[-1])
            solution, q, residual, _ = newton(problem.equations, ahead, q, tangent)
            if residual < SOLVING.residual:
                margin = float(margins_of(problem, solution, q)[index])
                if best is None or margin > best[0]:
                    best = margin, side, (solution, q)
        found.append(best and best[2])
        sides = sides if best is None else (best[1],)
    return found


def _simulated(problem: CycleProblem, u: np.ndarray, p: float) -> Iterator[tuple[BranchAtBorder, str]]:
    """Yield attractors that a simulation reaches from the border orbit at parameter values close to the border, on both sides."""
    orbit = problem.orbit(u, p)
    own_key = _key(orbit)
    for away, side in product(BORDERING.simulated_at, (1.0, -1.0)):
        q = p + side * away * parameter_unit(problem, p)
        found, _ = settled(orbit, problem.values(q))
        if found is None or (problem.forced and found.periods % problem.periods) or _key(found) == own_key:
            continue
        if not _same_friction_loss(orbit, found) or distance(orbit, found) > CLOSE:
            continue
        other = problem.sibling(found.word, found.periods, found.symmetric)
        v = other.reduce(found.nodes)
        nearer = _continued_towards(other, v, q, p)
        if nearer is None or not tends(distance(orbit, nearer), lambda found=found: distance(orbit, found)):
            continue  # another attractor, not connected to the border
        yield BranchAtBorder(other, v, q, None), "the simulator goes on"


def _key(orbit: Orbit) -> Hashable:
    same = size_of_one(orbit.nodes)
    return canonical(orbit.word, orbit.periods, orbit.nodes, forced=orbit.forced, same=same)[0]


def _same_friction_loss(one: Orbit, other: Orbit) -> bool:
    """Whether two motions dissipate about the same energy by friction; True for machines without that measure."""
    if "friction_loss" not in one.flow.measure_names(one.model):
        return True
    losses = [orbit.measure("friction_loss") / orbit.periods for orbit in (one, other)]
    energy = one.model.gauge("energy", other.params) * math.prod(one.model.natural_units(one.params)) ** 2
    return bool(abs(losses[0] - losses[1]) <= 0.05 * energy)


def _continued_towards(problem: CycleProblem, u: np.ndarray, q: float, p: float) -> Orbit | None:
    """Continue the orbit at q towards the border at p as far as Newton's method converges; None if it becomes virtual on the way."""
    found = problem.orbit(u, q)
    for part in NEARER:
        value = p + part * (q - p)
        u, residual = solved_at(problem.equations, u, value)
        if not residual < SOLVING.residual:
            break
        if margins_of(problem, u, value).min() < REAL:
            return None
        found = problem.orbit(u, value)
    return found


def read_alike(seed: Seed, before: Orbit) -> Seed:
    """Rotate the seed's orbit to the event that corresponds to the first event of the orbit before the border."""
    if not len(seed.problem.word) or not len(before.word):
        return seed
    orbit = seed.problem.orbit(seed.u, seed.p)
    places = _first_event(orbit, before)
    if places == 0:
        return seed
    turned = orbit.rotate(places)
    problem = seed.problem.sibling(turned.word, turned.periods, seed.problem.symmetric, seed.problem.params)
    nodes = turned.nodes.copy()
    if orbit.forced:
        nodes[:, 0] -= 2.0 * np.pi * round((nodes[0, 0] - before.nodes[0, 0]) / (2.0 * np.pi))
    tangent = seed.tangent
    if tangent is not None:
        along = np.roll(whole_direction(seed.problem, tangent[:-1]), -places, axis=0)[: problem.length]
        tangent = np.append(along.ravel(), tangent[-1])
    return seed._replace(problem=problem, u=problem.reduce(nodes), tangent=tangent)


def whole_direction(problem: CycleProblem, direction: np.ndarray) -> np.ndarray:
    """Expand a direction of the unknowns to the nodes of the whole cycle."""
    along = np.asarray(direction).reshape(problem.length, -1)
    if not problem.symmetric:
        return along
    image = -along
    image[:, 0] = along[:, 0]
    return np.concatenate([along, image])


def _first_event(orbit: Orbit, before: Orbit) -> int:
    """Index of the event nearest in phase (of a self-excited motion: in state) to the old first event, of the same letter if possible, never a slip."""
    word = orbit.word
    kinds = [word.letter(i).kind for i in range(len(word))]
    choices = [i for i, letter in enumerate(word.events) if letter == before.word.events[0]]
    choices = choices or [i for i, kind in enumerate(kinds) if kind == HIT]
    choices = choices or [i for i, kind in enumerate(kinds) if kind != SLIP]
    if not orbit.forced:
        gaps = np.abs(orbit.nodes[:, 1:] - before.nodes[0, 1:]).max(axis=1)
        return min(choices, key=lambda i: gaps[i])
    whole = 2.0 * np.pi * before.periods
    phases, first = orbit.nodes[:, 0].tolist(), float(before.nodes[0, 0])
    return min(choices, key=lambda i: abs((phases[i] - first + 0.5 * whole) % whole - 0.5 * whole))


def from_rest(problem: CycleProblem, point: BorderPoint) -> list[Seed]:
    """Seed of the stick-slip motion just beyond the border at which a stuck absorber begins to slip."""
    p = float(point.value)
    for away in BORDERING.slipping:
        for side in (1.0, -1.0):
            q = p + side * away * parameter_unit(problem, p)
            if Orbit.at_rest(problem.model, problem.values(q)).real:
                continue
            values = problem.model.named(problem.values(q))
            try:
                orbit = find(problem.model, "ss", 1, None, values)
            except (StartError, ValueError):
                continue
            other = problem.sibling(orbit.word, orbit.periods, orbit.symmetric)
            u, q = other.reduce(orbit.nodes), other.value(orbit.params)
            length = orbit.model.natural_units(orbit.params)[0]
            if np.ptp(orbit.sample()["w"]) < CLOSE * length and followed(orbit):
                sign = np.zeros(other.dimension + 1)
                sign[-1] = side
                note = "the stuck absorber begins to slip: persistence, the word becomes ss"
                return [Seed(other, u, q, sign, "border", note, True)]
    return []


def to_rest(problem: CycleProblem, point: BorderPoint) -> list[Seed]:
    """Seed of the stuck absorber, at the border at which the slips of a stick-slip motion vanish; empty at other borders."""
    if not problem.model.in_cavity or sorted(problem.word.events) != ["s", "s", "u", "u"]:
        return []
    p = float(point.value)
    unit = parameter_unit(problem, p)
    for side in (-1.0, 1.0):
        q = p + side * BORDERING.simulated_at[-1] * unit
        orbit = Orbit.at_rest(problem.model, problem.values(q))
        beyond = Orbit.at_rest(problem.model, problem.values(p - side * BORDERING.simulated_at[-1] * unit))
        if orbit.margin > 0.0 >= beyond.margin:  # a rounding error counts as zero
            other = problem.sibling(orbit.word, 1, orbit.symmetric)
            direction = np.zeros(other.dimension + 1)
            direction[-1] = side
            note = "the slips vanish: persistence, the absorber is stuck"
            return [Seed(other, other.reduce(orbit.nodes), q, direction, "border", note, True)]
    return []


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
    return near or "; ".join([UNKNOWN.format(contact=contact), *_simulated_outcomes(problem, orbit, p)])


def _contact(orbit: Orbit, index: int) -> str:
    """Description of the contact to which a margin belongs."""
    word = orbit.word
    place, watched = place_of(word, index)
    if watched < 0:
        watched = word.letter(place).contact if len(word) else 0
    return word.alphabet.contacts[watched].described


def _nearly_vanishing(orbit: Orbit) -> str:
    """Description of other events that nearly vanish at the border; empty if there are none."""
    margins, word = orbit.relative_margins, orbit.word
    speeds = [
        m.value for m in margins if m.kind == "approach" and BORDERING.certain < m.value < BORDERING.slow
    ]
    turns = [k for k in range(len(word)) if word.letter(k).kind == TURN]
    gaps = [
        m.value
        for m in margins
        if m.kind == "wall" and m.segment in turns and BORDERING.certain < m.value < BORDERING.slow
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
    values = {(m.kind, m.segment): m.value for m in margins}
    for place in range(len(word)):
        pair = values.get(("duration", place), np.inf), values.get(("stick", place), np.inf)
        if word.letter(place).kind == STICK and min(pair) > BORDERING.certain and max(pair) < BORDERING.slow:
            return (
                f"a stick that lasts {pair[0]:.1e} of the machine's own time, with {pair[1]:.1e} of its friction in reserve, is about to "
                "vanish as well: motions between the two borders cannot be resolved"
            )
    return ""


def _simulated_outcomes(problem: CycleProblem, orbit: Orbit, p: float) -> list[str]:
    """Descriptions of the motions that a simulation reaches from the border orbit, above and below the border."""
    outcomes = {}
    for side, name in ((1.0, "above"), (-1.0, "below")):
        found, kind = settled(
            orbit, problem.values(p + side * BORDERING.simulated_at[0] * parameter_unit(problem, p))
        )
        if found is None:
            outcomes[name] = ENDS.get(kind, kind)
        elif found.word.canonical().events == orbit.word.canonical().events:
            outcomes[name] = "stays with this word"
        else:
            outcomes[name] = f"settles on {found.spelling or 'a motion without events'} elsewhere"
    if outcomes["above"] == outcomes["below"]:
        return [f"simulation {outcomes['above']} on either side"]
    return [f"simulation {outcome} just {name} it" for name, outcome in outcomes.items()]


def piled_up(orbit: Orbit, approaches: np.ndarray) -> bool:
    """Whether an impact of the border orbit rebounds so slowly that the events after it cannot be resolved."""
    hits = [place for place in range(len(orbit.word)) if orbit.word.letter(place).kind == HIT]
    return any(
        speed > BORDERING.certain and orbit.flow.restitution(orbit, place) * speed < BORDERING.unresolved
        for speed, place in zip(approaches.tolist(), hits)
    )


def _gives_way_one_way(orbit: Orbit) -> bool:
    """Whether friction and slope together hold the absorber more firmly in one direction."""
    model = orbit.model
    if not isinstance(model, Model):
        return False
    left, right = model.rest.reserves(orbit.params)
    return bool(abs(left - right) > EVENTS.zero * model.friction_acceleration(orbit.params))


def settled(orbit: Orbit, params: np.ndarray) -> tuple[Orbit | None, str]:
    """Simulate from an orbit's first event with other parameters: the periodic motion reached (None if there is none), and the kind of motion or the error."""
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
