"""Across a border of a declared machine: the word on the other side, and the orbit with which its branch begins.

The rules of `edits` propose the word, and what vanishes at the border is given a size; where they do not lead on, the simulator
writes the word. A proposal counts only if its equations have a real solution next to the border and the simulator follows it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from orbits.contacts.changes import Change, Grows, What
from orbits.contacts.letters import SLIP, STICK
from orbits.machines.declared.attractor import settle
from orbits.machines.declared.deviation import deviation
from orbits.machines.declared.edits import Edit, edits_at
from orbits.machines.declared.margins import per_node
from orbits.machines.declared.orbit import REAL, DeclaredOrbit
from orbits.machines.declared.sampling import lengths, sample
from orbits.machines.declared.solving import SOLVED, examined, newton
from orbits.machines.declared.stepper import SimulationError, Stepper
from orbits.machines.declared.system import DeclaredSystem
from orbits.protocol import Seed
from orbits.words.rewriting import applied, spliced

SIZES = ((2e-3, 2e-4, 2e-5), (1e-4, 2e-5), (2e-6, 2e-7), (2e-8,))  # of what grows beyond the border
FOLLOWED = 1e-5  # deviation of the simulation up to which it follows an orbit next to a border
NEAR = 0.02  # change of the parameter, relative, beyond which an orbit is not next to the border
GROWING = 1e-4  # least growth of the margins with the distance from a border
SAME = 1e-5  # largest difference of states, at equal clocks, of one and the same motion
CLOSE = 0.05  # of one that goes on from the border
Found = tuple[DeclaredSystem, np.ndarray, float, np.ndarray]


def cross(problem: DeclaredSystem, point: Any) -> list[Seed]:
    """Seeds of the branches on the other side of a border (as `orbits.borders.crossing.cross`)."""
    u, p = np.asarray(point.u, dtype=float), float(point.value)
    index = int(point.margin_index)
    old_side = _real_side(problem, u, p, np.asarray(point.tangent, dtype=float), index)
    seeds = []
    for other, v, q, tangent, note in (*proposals(problem, u, p, index), *_simulated(problem, u, p)):
        if not _followed(DeclaredOrbit.of(other, v, q)):
            continue
        smallest, v, tangent = _simplest(other, v, q, tangent)
        persistence = bool(np.sign(q - p) != old_side)
        kind = "persistence" if persistence else "nonsmooth fold"
        text = f"{note}: {kind}, the word becomes {smallest.word.text or 'free of events'}"
        seeds.append(Seed(smallest, v, q, tangent, "border", text, persistence))  # type: ignore[arg-type]
        break
    return seeds + list(_escapes(problem, u, p, index))


def _followed(orbit: DeclaredOrbit) -> bool:
    return orbit.margin >= REAL and deviation(orbit) < FOLLOWED


def _simplest(
    problem: DeclaredSystem, u: np.ndarray, p: float, tangent: np.ndarray | None
) -> tuple[DeclaredSystem, np.ndarray, np.ndarray | None]:
    """The orbit in the smallest problem that has it: it may repeat a shorter one, or be symmetric."""
    root = DeclaredOrbit.of(problem, u, p).root()
    if len(root.word) == len(problem.word) and root.symmetric == problem.symmetric:
        return problem, u, tangent
    smallest = problem.sibling(root.word, root.periods, root.symmetric)
    return smallest, smallest.reduce(root.nodes), None


def turned(
    problem: DeclaredSystem, u: np.ndarray, p: float, index: int
) -> tuple[DeclaredSystem, np.ndarray, int]:
    """The same border read from another event, so that what changes does not straddle the end of the word."""
    width = per_node(problem.contacts)
    place, column = divmod(index, width)
    if problem.length < 3:
        first = place if column < problem.contacts or column == width - 1 else place - 1
    else:
        first = place - 1
    if first % problem.length == 0 or not len(problem.word):
        return problem, u, index
    orbit = DeclaredOrbit.of(problem, u, p).rotate(first % len(problem.word))
    other = problem.sibling(orbit.word, problem.periods, problem.symmetric)
    return other, other.reduce(orbit.nodes), width * ((place - first) % problem.length) + column


def proposals(
    problem: DeclaredSystem, u: np.ndarray, p: float, index: int
) -> Iterator[tuple[DeclaredSystem, np.ndarray, float, np.ndarray, str]]:
    """Solutions next to the border with the words that the rules propose."""
    first = problem
    problem, u, index = turned(problem, u, p, index)
    orbit = DeclaredOrbit.of(problem, u, p)
    for edit in edits_at(orbit, index):
        found = grown(problem, orbit, p, [edit])
        if found is not None:
            yield (*_read_alike(first, problem, edit.change, found), edit.change.what.value)


def _read_alike(first: DeclaredSystem, problem: DeclaredSystem, edit: Change, found: Found) -> Found:
    """The orbit found, read from the event from which the border orbit was read before it was turned; never from a slip."""
    ahead = next((k for k in range(len(first.word)) if problem.word.rotate(k) == first.word), 0)
    grown_by = len(edit.events) - (edit.stop - edit.start)
    places = ahead + grown_by
    if (
        problem.symmetric and ahead >= problem.length + edit.stop
    ):  # the mirrored edit stands before it as well
        places += grown_by
    if ahead == 0 or ahead < edit.stop or places <= 0:
        places = 0
    return _unslipped(_rotated(found, places))


def _rotated(found: Found, places: int) -> Found:
    """The same orbit and direction, read `places` events further on."""
    other, v, q, tangent = found
    if places == 0 or not len(other.word):
        return found
    orbit = DeclaredOrbit.of(other, v, q).rotate(places)
    again = other.sibling(orbit.word, other.periods, other.symmetric)
    direction = np.roll(other.expand_direction(tangent[:-1]), -places, axis=0)[: again.length]
    return again, again.reduce(orbit.nodes), q, np.append(direction.ravel(), tangent[-1])


def _unslipped(found: Found) -> Found:
    """Read from the stick before a slip that would come first."""
    word = found[0].word
    slips = len(word) > 1 and word.letter(0).kind == SLIP and word.letter(-1).kind == STICK
    return _rotated(found, len(word) - 1) if slips else found


def grown(problem: DeclaredSystem, orbit: DeclaredOrbit, p: float, edits: list[Edit]) -> Found | None:
    """Solve for the new word with the vanishing quantity at small sizes; the smallest that converges."""
    length = problem.length
    forced = problem.forced
    empty = not len(problem.word)
    changes, placed = [edit.change for edit in edits], [edit.nodes for edit in edits]
    halved = (
        problem.symmetric
        if not empty
        else bool(edits[0].change.events) and problem.word.mirror_symmetric_halves
    )
    if halved:  # the same happens half a period later to the mirror image
        if not empty and any(change.stop > length for change in changes):
            return None
        word, first = applied(orbit.word if empty else orbit.word.head(length), changes)
        nodes = spliced(orbit.nodes[:length], changes, placed, empty)
        word = word.with_image()
    else:
        word, first = applied(orbit.word, changes)
        nodes = spliced(orbit.nodes, changes, placed, empty)
    if not forced:
        nodes = _durations(orbit, nodes, edits[0])
    try:
        other = problem.sibling(word, problem.periods, halved and bool(len(word)))
    except ValueError:
        return None
    if not len(word):
        nodes = _strobed(orbit)
    guess = np.ascontiguousarray(nodes, dtype=float).ravel()
    if changes[0].grows is Grows.MARGIN:
        return _beside(other, guess, p)
    for sizes in SIZES:
        found = _climb(other, guess, first, changes[0], p, sizes)
        if found is not None and _margins(found[0], found[1], found[2]).min() >= REAL:
            return found
    return None


def _margins(problem: DeclaredSystem, u: np.ndarray, p: float) -> np.ndarray:
    return np.nan_to_num(examined(problem, u, p)[2], nan=-np.inf, posinf=np.inf)


def _durations(orbit: DeclaredOrbit, nodes: np.ndarray, edit: Edit) -> np.ndarray:
    """Durations after an edit of a self-excited orbit, whose inserted nodes carry clocks from the flight's start."""
    nodes = nodes.copy()
    change, m = edit.change, len(edit.change.events)
    if change.start == change.stop and m:  # inserted into the flight before `start`
        whole = float(orbit.nodes[change.start - 1, 0])
        inside = edit.nodes[:, 0]
        nodes[change.start - 1, 0] = inside[0]
        for k in range(m):
            until = inside[k + 1] if k + 1 < m else whole
            nodes[change.start + k, 0] = until - inside[k]
    elif not m:  # removed: the flight before takes over
        gone = float(orbit.nodes[change.start : change.stop, 0].sum())
        nodes[(change.start - 1) % len(nodes), 0] += gone
    elif m == 2 and change.stop - change.start == 1:
        nodes[change.start, 0] = 2e-3
        nodes[change.start + 1, 0] = max(float(orbit.nodes[change.start, 0]) - 2e-3, 1e-6)
    return nodes


def _strobed(orbit: DeclaredOrbit) -> np.ndarray:
    """Node at phase zero of a motion on which nothing happens any more."""
    table = sample(orbit, 4000)
    phase = table["phase"] / (2.0 * np.pi)
    k = int(np.argmin(np.abs(phase - np.round(phase))))
    return np.array([[0.0, *(table[name][k] for name in orbit.machine.states)]])


def _climb(
    other: DeclaredSystem, guess: np.ndarray, first: int, change: Change, p: float, sizes: tuple[float, ...]
) -> Found | None:
    """Solve with what grows beyond the border held at each of the sizes in turn; the last that converges."""
    d, size = other.size + 1, other.dimension
    best = None
    u, q = guess.copy(), p
    for wanted in sizes:
        border = np.zeros(size + 1)
        if change.grows is Grows.GAP:
            if other.forced:
                border[first * d], border[((first + 1) * d) % size] = -1.0, 1.0
                middle = 0.5 * (u[first * d] + u[(first + 1) * d])
                early = middle - 0.5 * wanted
                if change.start != change.stop:
                    early = u[first * d]
                elif change.what is What.STICK_APPEARS:
                    early = u[(first + 1) * d] - wanted
                u[first * d], u[(first + 1) * d] = early, early + wanted
            else:
                border[first * d] = 1.0
                u[first * d] = wanted
        else:
            rate, slope, push = _approach(other, u, q, first)
            border[first * d + 1 : (first + 1) * d] = slope
            u[first * d + 1 : (first + 1) * d] += push * (wanted - rate) / float(slope @ push)
        trial, q_new, residual, tangent = newton(other, u, q, border)
        if not residual < SOLVED or abs(q_new - p) > NEAR * max(1.0, abs(p)):
            break
        u, q = trial, q_new
        best = (other, u.copy(), q, tangent / np.abs(tangent).max())
    return best


def _approach(
    problem: DeclaredSystem, u: np.ndarray, p: float, place: int
) -> tuple[float, np.ndarray, np.ndarray]:
    """Rate of a wall's gap after an impact, its slope by the states, and the push of that wall."""
    compiled, d = problem.machine.compiled, problem.size + 1
    wall = problem.letters[place].contact
    node = u[place * d : (place + 1) * d]
    numbers = compiled.numbers(problem.values(p), problem.word.modes[place])
    row = compiled.approach(wall)(node[None, 1:], node[:1] if problem.forced else np.zeros(1), numbers[None])[
        0
    ]
    return float(row[0]), row[1:d], row[d:]


def _beside(other: DeclaredSystem, guess: np.ndarray, p: float) -> Found | None:
    """The new word's branch through the border itself, on the side where its margins grow."""
    u, q, residual, tangent = newton(other, guess, p)
    if not residual < SOLVED:
        return None
    tangent = tangent / np.linalg.norm(tangent)
    for length in (1e-3, 1e-4, 1e-5, 1e-6):
        best, most = None, GROWING * length
        for sign in (1.0, -1.0):
            v, r, residual, along = newton(
                other, u + sign * length * tangent[:-1], q + sign * length * tangent[-1], tangent
            )
            if not residual < SOLVED:
                continue
            smallest = float(_margins(other, v, r).min())
            if smallest > most:
                along = along / np.linalg.norm(along)
                best, most = (other, v, r, sign * along), smallest
        if best is not None:
            return best
    return None


def _real_side(problem: DeclaredSystem, u: np.ndarray, p: float, tangent: np.ndarray, index: int) -> float:
    """Sign of the parameter's change from the border into the branch's real part."""
    length = 1e-4 / max(float(np.abs(tangent).max()), 1e-12)
    sides = []
    for sign in (1.0, -1.0):
        v, q, residual, _ = newton(
            problem, u + sign * length * tangent[:-1], p + sign * length * float(tangent[-1]), tangent
        )
        if residual < SOLVED:
            sides.append((float(_margins(problem, v, q)[index]), q - p))
    return float(np.sign(max(sides)[1])) if sides else 0.0


def _escapes(problem: DeclaredSystem, u: np.ndarray, p: float, index: int) -> Iterator[Seed]:
    """Orbits of less symmetry that leave at the border itself: the change happens in one half only, or every other time."""
    if not len(problem.word):
        return
    problem, u, index = turned(problem, u, p, index)
    orbit = DeclaredOrbit.of(problem, u, p)
    if problem.symmetric:
        wider, what = (
            problem.sibling(problem.word, problem.periods, False),
            "the symmetry breaks at the border",
        )
    else:
        orbit = orbit.repeat(2)
        wider = problem.sibling(orbit.word, orbit.periods, False)
        what = "the period doubles at the border"
    for edit in edits_at(orbit, index):
        found = grown(wider, orbit, p, [edit])
        if found is None:
            continue
        other, v, q, tangent = found
        there = DeclaredOrbit.of(other, v, q)
        if there.symmetric or len(there.root().word) != len(other.word) or not _followed(there):
            continue
        note = f"{edit.change.what.value}: {what}, the word becomes {other.word.text}"
        yield Seed(other, v, q, tangent, "border", note, False)  # type: ignore[arg-type]
        return


def _simulated(
    problem: DeclaredSystem, u: np.ndarray, p: float
) -> Iterator[tuple[DeclaredSystem, np.ndarray, float, None, str]]:
    """Attractors that the simulator reaches from the border orbit, a little to both sides of it."""
    orbit = DeclaredOrbit.of(problem, u, p)
    here = problem.canonical(u, p)[0]
    for side in (1.0, -1.0):
        q = p + side * 1e-6 * max(1.0, abs(p))
        stepper = Stepper(problem.machine, problem.values(q))
        try:
            stepper.start(
                orbit.nodes[0, 1:], float(orbit.nodes[0, 0]) if problem.forced else 0.0, orbit.word.modes[0]
            )
            found = settle(stepper, 60, max(2 * problem.periods, 4))
        except SimulationError:
            continue
        if found is None or (problem.forced and found.periods % problem.periods):
            continue
        other = problem.sibling(found.word, found.periods, found.symmetric, found.params)
        if other.canonical(other.reduce(found.nodes), q)[0] == here or distance(orbit, found) > CLOSE:
            continue
        yield other, other.reduce(found.nodes), q, None, "the simulator goes on"


def distance(one: DeclaredOrbit, other: DeclaredOrbit, points: int = 300) -> float:
    """How far two motions are apart, whatever their words; the mirror image of a motion counts as the same.

    Forced: the states at equal phases, but for the instants at which one of them jumps a little earlier. Self-excited: periods and
    extremes.
    """
    if not one.machine.forced:
        names = [n for n in one.problem().measure_names if n.startswith(("max_", "min_", "period"))]
        a, b = one.measures(*names), other.measures(*names)
        scale = 1.0 + max(abs(v) for v in a.values())
        return max(abs(a[n] - b[n]) for n in names) / scale
    images = [other]
    if one.machine.alphabet.mirror is not None:
        images.append(other.mirror())
    return min(_apart(one, image, points) for image in images)


def _apart(one: DeclaredOrbit, other: DeclaredOrbit, points: int) -> float:
    periods = max(one.periods, other.periods)
    if periods % one.periods or periods % other.periods:
        return np.inf
    phases = np.linspace(0.0, 2.0 * np.pi * periods, points * periods, endpoint=False)
    a, b = _states(one, phases), _states(other, phases)
    jumps = 2 * (len(one.word) + len(other.word)) + 2
    best = np.inf
    for shift in range(periods):
        gap = np.abs(a - np.roll(b, shift * points, axis=0)).max(axis=1)
        best = min(best, float(np.sort(gap)[max(0, len(gap) - 1 - jumps)]))
    return best


def _states(orbit: DeclaredOrbit, phases: np.ndarray) -> np.ndarray:
    """States at phases from 0 on, shape (m, n)."""
    compiled, e = orbit.machine.compiled, orbit.machine.equations
    spans, whole = lengths(orbit), 2.0 * np.pi * orbit.periods
    out = np.empty((len(phases), orbit.machine.size))
    for i, span in enumerate(spans):
        begin = float(orbit.nodes[i, 0])
        inside = np.mod(phases - begin, whole)
        places = np.flatnonzero(inside < span)
        if not places.size:
            continue
        order = places[np.argsort(inside[places])]
        mode = orbit.word.modes[i % len(orbit.word.modes)]
        grid = begin + np.concatenate([[0.0], inside[order]])
        path = compiled.watch(e.pattern_key(mode)).path(
            orbit.nodes[i, 1:], grid, compiled.numbers(orbit.params, mode)
        )
        out[order] = path[1:]
    return out
