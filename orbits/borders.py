"""Across a border: the word on the other side, and the orbit with which its branch begins.

The local rules of `orbits.rewriting` propose the word; where they do not, the simulator writes it. A proposal counts only
if its maps have a real solution next to the border and the simulator, which knows no word, follows it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from orbits.compiled import assemble
from orbits.monitors import PER_NODE
from orbits.orbit import Orbit
from orbits.problem import OrbitProblem
from orbits.rewriting import Edit, applied, edits_at
from orbits.words import Word

NEAR = 1e-7  # margins this small vanish together
SIZES = ((2e-3, 2e-4, 2e-5), (1e-4, 2e-5), (2e-6, 2e-7), (2e-8,))  # of what grows beyond the border: ways to try
REAL = -1e-9  # smallest margin of a real orbit
FOLLOWED = 1e-6  # largest replay error of a seed
GROWING = 1e-4  # least growth of a margin with the distance from the border


class Seed(NamedTuple):
    """Where the branch on the other side begins; `tangent` leads away from the border."""

    problem: OrbitProblem
    u: np.ndarray
    p: float
    tangent: np.ndarray | None
    kind: str
    note: str
    persistence: bool


def cross(problem: OrbitProblem, point: Any) -> list[Seed]:
    """Seeds of the branches on the other side of a border.

    Parameters
    ----------
    problem : OrbitProblem
    point : special point
        With `u`, `value`, `tangent` and `margin_index`.

    Returns
    -------
    list of Seed
        Usually one; empty if neither the local rules nor the simulator find an orbit there.
    """
    u, p = np.asarray(point.u, dtype=float), float(point.value)
    rest = _to_rest(problem, point)
    if rest:
        return rest
    old_side = _real_side(problem, u, p, np.asarray(point.tangent, dtype=float), int(point.margin_index))
    seeds = []
    for candidate in (*_proposals(problem, u, p, int(point.margin_index)), *_simulated(problem, u, p)):
        other, v, q, tangent, note = candidate
        orbit = other.orbit(v, q)
        if not _followed(orbit):
            continue
        smallest, v, tangent = _simplest(other, orbit, v, tangent)
        persistence = bool(np.sign(q - p) != old_side)
        kind = "persistence" if persistence else "nonsmooth fold"
        text = f"{note}: {kind}, the word becomes {smallest.word.text}"
        seeds.append(Seed(smallest, v, q, tangent, "border", text, persistence))
        if smallest is not other:
            seeds.extend(_onwards(smallest, v, p))
        break
    return seeds + list(_escapes(problem, u, p, int(point.margin_index)))


def _followed(orbit: Orbit) -> bool:
    return orbit.margin >= REAL and orbit.replay() < FOLLOWED


def _simplest(
    problem: OrbitProblem, orbit: Orbit, u: np.ndarray, tangent: np.ndarray | None
) -> tuple[OrbitProblem, np.ndarray, np.ndarray | None]:
    """The orbit in the smallest problem that has it: it may repeat a shorter one, or be symmetric."""
    root = orbit.root()
    if root.periods == problem.periods and root.symmetric == problem.symmetric:
        return problem, u, tangent
    smallest = problem.sibling(root.word, root.periods, root.symmetric)
    return smallest, smallest.reduce(root.nodes), None


def _onwards(problem: OrbitProblem, u: np.ndarray, p: float) -> Iterator[Seed]:
    """Where the simpler orbits, on whose border a branch of less symmetry ends, go on themselves."""
    at_border, residual = _solved_at(problem, u, p)
    if not residual < 1e-10:
        return
    index = int(np.argmin(np.abs(_row(problem, at_border, p))))
    for other, v, q, tangent, note in _proposals(problem, at_border, p, index):
        if _followed(other.orbit(v, q)):
            text = f"{note}: the branches meet at the border, the word becomes {other.word.text}"
            yield Seed(other, v, q, tangent, "border", text, False)
            return


def _solved_at(problem: OrbitProblem, guess: np.ndarray, p: float) -> tuple[np.ndarray, float]:
    """Solution at a parameter value, and its residual."""
    border = np.zeros(problem.dimension + 1)
    border[-1] = 1.0
    step, tangent = np.empty_like(border), np.empty_like(border)
    u = guess.copy()
    residual, _, _ = assemble(problem.model).newton(
        problem.data, u, p, problem.workspace(), border, step, tangent, 1e-12, 40
    )
    return u, float(residual)


def _escapes(problem: OrbitProblem, u: np.ndarray, p: float, index: int) -> Iterator[Seed]:
    """Orbits of less symmetry that leave at the border itself: the change happens in one half only, or every other time."""
    problem, u, index = _turned(problem, u, p, index)
    orbit = problem.orbit(u, p)
    if problem.symmetric:
        wider = problem.sibling(problem.word, problem.periods, False)
        what = "the symmetry breaks at the border"
    else:
        nodes = orbit.nodes.copy()
        nodes[:, 0] += 2.0 * np.pi * orbit.periods
        orbit = Orbit(
            orbit.model, orbit.word.double(), 2 * orbit.periods, np.concatenate([orbit.nodes, nodes]), orbit.params
        )
        wider = problem.sibling(orbit.word, orbit.periods, False)
        what = "the period doubles at the border"
    for change in edits_at(orbit, index, problem.length):
        found = _grow(wider, orbit, p, [change])
        if found is None:
            continue
        other, v, q, tangent = found
        grown = other.orbit(v, q)
        if grown.symmetric or grown.root().periods != other.periods or not _followed(grown):
            continue
        note = f"{change.note}: {what}, the word becomes {other.word.text}"
        yield Seed(other, v, q, tangent, "border", note, False)
        return


def from_rest(problem: Any, point: Any) -> list[Seed]:
    """The stick-slip motion just beyond the slip of a stuck one: closed form, or what the simulator finds."""
    from orbits.start import StartError, find

    p = float(point.value)
    for distance in (1e-4, 1e-3):
        for side in (1.0, -1.0):
            q = p * (1.0 + side * distance)
            if problem.orbit(problem_response(problem, q), q).real:
                continue
            values = dict(
                zip(problem.model.parameter_names, (float(x) for x in problem.values(q)), strict=True)
            )
            try:
                orbit = find(problem.model, "ss", 1, None, values)
            except (StartError, ValueError):
                continue
            other = orbit.problem(problem.parameter)
            u, q = orbit.seed(other)
            if orbit.real and orbit.replay() < FOLLOWED:
                sign = np.zeros(other.dimension + 1)
                sign[-1] = side
                note = "the stuck absorber begins to slip: persistence, the word becomes ss"
                return [Seed(other, u, q, sign, "border", note, True)]
    return []


def problem_response(problem: Any, p: float) -> np.ndarray:
    """Unknowns of the stuck motion at parameter value `p`."""
    from orbits.stuck import linear_response

    return np.linalg.solve(*linear_response(problem.model, problem.values(p)))


def _to_rest(problem: OrbitProblem, point: Any) -> list[Seed]:
    """The stuck motion on the other side of the border at which stick-slip ends, if that is what ends there."""
    from orbits.stuck import StuckOrbit

    if problem.word.text not in ("ss", "s-s+"):
        return []
    p = float(point.value)
    for side in (-1.0, 1.0):
        q = p * (1.0 + side * 1e-7)
        orbit = StuckOrbit.of(problem.model, problem.values(q))
        beyond = StuckOrbit.of(problem.model, problem.values(p * (1.0 - side * 1e-7)))
        if orbit.margin > 0.0 > beyond.margin:
            other = orbit.problem(problem.parameter)
            direction = np.zeros(other.dimension + 1)
            direction[-1] = side
            note = "the slips vanish: persistence, the absorber is stuck"
            return [Seed(other, orbit.u, q, direction, "border", note, True)]  # type: ignore[arg-type]
    return []


def _row(problem: OrbitProblem, u: np.ndarray, p: float) -> np.ndarray:
    """Margins of a solution."""
    row = np.empty(2 * problem.n_multipliers + problem.n_margins)
    assemble(problem.model).examine(problem.data, u, p, problem.workspace(), row)
    return row[2 * problem.n_multipliers :]


def _real_side(problem: OrbitProblem, u: np.ndarray, p: float, tangent: np.ndarray, index: int) -> float:
    """Sign of the parameter's change from the border into the branch's real part.

    Solutions a little ahead and behind are solved for: where a stick vanishes in a flight the branch turns back at the
    border, so its tangent does not tell.
    """
    kernels, work = assemble(problem.model), problem.workspace()
    step, along = np.empty(u.size + 1), np.empty(u.size + 1)
    length = 1e-4 / max(float(np.abs(tangent).max()), 1e-12)
    sides = []
    for sign in (1.0, -1.0):
        there = u + sign * length * tangent[:-1]
        q = p + sign * length * float(tangent[-1])
        residual, _, q = kernels.newton(problem.data, there, q, work, tangent, step, along, 1e-13, 40)
        if residual < 1e-10:
            sides.append((float(_row(problem, there, float(q))[index]), float(q) - p))
    if not sides:
        return 0.0
    return float(np.sign(max(sides)[1]))


def _turned(
    problem: OrbitProblem, u: np.ndarray, p: float, index: int
) -> tuple[OrbitProblem, np.ndarray, int]:
    """The same border read from another event, so that what changes does not straddle the end of the word."""
    place, column = divmod(index, PER_NODE)
    letter = problem.word.events[place]
    if 0 < place < problem.length - 1 or (place == 0 and letter != "u") or problem.length < 2:
        return problem, u, index
    first = place - 1 if letter == "u" else place
    turned = problem.orbit(u, p).rotate(first % len(problem.word))
    other = problem.sibling(turned.word, problem.periods, problem.symmetric)
    return other, other.reduce(turned.nodes), PER_NODE * (place - first) + column


def _proposals(
    problem: OrbitProblem, u: np.ndarray, p: float, index: int
) -> Iterator[tuple[OrbitProblem, np.ndarray, float, np.ndarray, str]]:
    """Solutions next to the border with the words that the local rules propose."""
    problem, u, index = _turned(problem, u, p, index)
    orbit = problem.orbit(u, p)
    values = _row(problem, u, p)
    together = [j for j in range(problem.n_margins) if j != index and abs(values[j]) < NEAR]
    for first in edits_at(orbit, index, problem.length):
        chosen = [first]
        for j in together:
            for change in edits_at(orbit, j, problem.length):
                if change.note == first.note and not any(_overlap(change, other) for other in chosen):
                    chosen.append(change)
                    break
        for edits in [chosen, [first]] if len(chosen) > 1 else [chosen]:
            found = _grow(problem, orbit, p, edits)
            if found is not None:
                yield (*found, first.note)


def _overlap(a: Edit, b: Edit) -> bool:
    return a.start < max(b.stop, b.start + 1) and b.start < max(a.stop, a.start + 1)


def _grow(
    problem: OrbitProblem, orbit: Orbit, p: float, edits: list[Edit]
) -> tuple[OrbitProblem, np.ndarray, float, np.ndarray] | None:
    """Solve for the new word with the vanishing quantity at small sizes; the smallest that converges."""
    if problem.symmetric:  # edit the half, and mirror it
        half = problem.length
        if any(change.stop > half and change.start != half for change in edits):
            return None
        word, nodes, first = applied(orbit.word.head(half), orbit.nodes[:half], edits)
        mirrored = word.mirror()
        word = Word(word.events + mirrored.events, word.modes + mirrored.modes, word.frictionless)
    else:
        word, nodes, first = applied(orbit.word, orbit.nodes, edits)
    if not len(word):
        return None
    try:
        other = problem.sibling(word, problem.periods, problem.symmetric)
    except ValueError:
        return None
    guess = np.ascontiguousarray(nodes, dtype=float).ravel()
    if edits[0].grows == "margin":
        return _beside(other, guess, p)
    for sizes in SIZES:
        found = _climb(other, guess, first, edits[0], p, sizes)
        if found is not None and found[0].orbit(found[1], found[2]).margin >= REAL:
            return found
    return None


def _climb(
    other: OrbitProblem, guess: np.ndarray, first: int, change: Edit, p: float, sizes: tuple[float, ...]
) -> tuple[OrbitProblem, np.ndarray, float, np.ndarray] | None:
    """Solve with what grows beyond the border held at each of the sizes in turn; the last that converges."""
    n, size = other.model.node, other.dimension
    kernels, work = assemble(other.model), other.workspace()
    step, tangent = np.empty(size + 1), np.empty(size + 1)
    best = None
    u, q = guess.copy(), p
    for wanted in sizes:
        border = np.zeros(size + 1)
        if change.grows == "gap":
            border[first * n], border[(first + 1) * n] = -1.0, 1.0
            if change.start == change.stop:  # the later event stays: friction gives way there
                u[first * n] = u[(first + 1) * n] - wanted
            else:
                u[(first + 1) * n] = u[first * n] + wanted
        else:
            sign = 1.0 if change.events[0] == "L" else -1.0
            cavity = float(other.orbit(u, q).events.v_rate[first])
            border[first * n + 1] = sign
            if n == 4:
                border[first * n + 3] = -sign
            else:
                values = other.values(q)
                border[first * n] = sign * values[0] * values[5] * np.sin(u[first * n])
                change_with = float(other.orbit(u, q + NEAR).events.v_rate[first]) - cavity
                border[size] = -sign * change_with / NEAR
            speed = sign * (u[first * n + 1] - cavity)
            u[first * n + 1] += sign * (wanted - speed)
        trial = u.copy()
        residual, _, q_new = kernels.newton(other.data, trial, q, work, border, step, tangent, 1e-12, 40)
        if not residual < 1e-10 or abs(q_new - p) > 0.02 * max(1.0, abs(p)):
            break
        u, q = trial, float(q_new)
        best = (other, u.copy(), q, tangent.copy())
    return best


def _beside(
    other: OrbitProblem, guess: np.ndarray, p: float
) -> tuple[OrbitProblem, np.ndarray, float, np.ndarray] | None:
    """Solve a regular word at fixed parameter values on both sides of the border; the side where it is real."""
    size = other.dimension
    kernels, work = assemble(other.model), other.workspace()
    border, step, tangent = np.zeros(size + 1), np.empty(size + 1), np.empty(size + 1)
    border[-1] = 1.0
    at_border = guess.copy()
    residual, _, _ = kernels.newton(other.data, at_border, p, work, border, step, tangent, 1e-12, 40)
    if not residual < 1e-10:
        return None
    for distance in (1e-8, 1e-7, 1e-6):
        sides = []
        for side in (1.0, -1.0):
            q = p + side * distance * max(1.0, abs(p))
            u = at_border + (q - p) * tangent[:-1]
            along = tangent.copy()
            residual, _, _ = kernels.newton(other.data, u, q, work, border, step, along, 1e-12, 40)
            if residual < 1e-10:
                sides.append((float(_row(other, u, q).min()), u, q, side * along))
        if sides:
            margin, u, q, along = max(sides, key=lambda entry: entry[0])
            if margin > GROWING * distance:  # not one that vanishes all along, as at a wall touched without speed
                return other, u, q, along
    return None


def _simulated(
    problem: OrbitProblem, u: np.ndarray, p: float
) -> Iterator[tuple[OrbitProblem, np.ndarray, float, None, str]]:
    """Attractors that the simulator reaches from the border orbit, a little to both sides of it."""
    from orbits.identity import canonical, is_symmetric
    from orbits.simulation.driver import machine
    from orbits.simulation.recurrence import settle
    from orbits.simulation.return_map import state_of
    from orbits.start import polish

    orbit = problem.orbit(u, p)
    engine = machine(problem.model.name)
    here = canonical(orbit.word, orbit.periods, orbit.nodes)[0]
    place = next((i for i, letter in enumerate(orbit.word.events) if letter != "u"), 0)
    for side in (1.0, -1.0):
        q = p + side * 1e-6 * max(1.0, abs(p))
        params = problem.values(q)
        state = state_of(
            engine, params, int(orbit.word.codes[place]), int(orbit.word.modes[place]), orbit.nodes[place]
        )
        state[1] = np.clip(state[1], -1.0, 1.0)
        attractor = settle(problem.model, engine, params, state, 60.0, max(2 * problem.periods, 4), 1e-6, 0)
        if attractor.word is None or not attractor.nodes.size:
            continue
        found = polish(attractor.orbit)
        if found is None or found.periods % problem.periods:
            continue
        if canonical(found.word, found.periods, found.nodes)[0] == here:
            continue
        if (
            abs(
                found.measure("friction_loss") / found.periods
                - orbit.measure("friction_loss") / orbit.periods
            )
            > 0.05
        ):
            continue
        symmetric = is_symmetric(found.word, found.periods, found.nodes)
        other = problem.sibling(found.word, found.periods, symmetric, found.params)
        yield other, other.reduce(found.nodes), q, None, "the simulator goes on"
