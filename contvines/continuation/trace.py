"""Tracing a branch: chunks of points from the loop, and ``trace``, a generator of points."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Generator, Iterator
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..journal import NullJournal
from ..long_work import listening
from ..problems.protocol import Problem
from .ends import Closing, Reach
from .engine import Engine, Solved
from .layout import OF_SOLVED, Chunk, Status, packed
from .settings import BY_ANGLE, Settings, hinting

if TYPE_CHECKING:
    from ..journal import Journal
    from .loop import InterpretedLoop
    from .native import NativeLoop


LARGEST = 2_000_000  # numbers in a chunk; chunks grow until then, or to eight times the setting
FEWEST = 8  # points in a chunk, however many unknowns there are
AGAIN = 32  # points that are traced again with shorter steps
ALONG = 0.7  # cosine of the angle between a tangent and the way to the next point on a mesh that moves along, at least


@dataclass(frozen=True, eq=False)
class Retrace:
    """Wish to go on from the last of the first ``count`` points of a chunk, at first with steps of at most ``longest``."""

    count: int
    longest: float


@dataclass(frozen=True, eq=False)
class Finer:
    """Wish to go on from the beginning of a chunk with another engine; ``image`` tells how points read there."""

    engine: Engine
    image: Callable[[Solved], Solved]


def chunks(
    engine: Engine,
    start: Solved,
    journal: Journal | None = None,
    key: str = "",
    stop_at_border: bool = False,
    first_step: float | None = None,
) -> Generator[Chunk, Retrace | Finer | None, None]:
    """Follow the branch from a point in the direction of its tangent, a chunk at a time.

    Who sees that a step of the chunk leads astray sends a :class:`Retrace`, and gets the next chunk from there; who needs another mesh
    sends a :class:`Finer`, and gets the same part of the branch on that.

    Parameters
    ----------
    engine : Engine
    start : Solved
    journal, key
        Each chunk is asked for, and recorded, under ``key/number``.
    stop_at_border : bool
        Stop at the first point with a negative margin (which is the last one yielded).
    first_step : float, optional

    Yields
    ------
    Chunk
        The last one has a status other than RUNNING. A closed branch ends with its first point again. The rows of all
        chunks share their memory: take from them what is needed before the next one.
    """
    settings, bound = engine.settings, engine.upper if start.tangent[-1] > 0.0 else engine.lower
    left = (bound - start.p) * np.sign(start.tangent[-1])
    if left <= engine.settled(start.p) and start.tangent[-1] != 0.0:
        end = engine.at_value(start.u, bound, start.tangent) if left > 0.0 else None  # no step is so short
        yield packed([start] if end is None else [start, end], Status.LEFT_INTERVAL)
        return
    motion = MeshMotion(engine)
    try:
        history = motion.adapted([motion.steered(start)])
        h, capacity = settings.first_step if first_step is None else first_step, settings.first_chunk
        closing, reach = Closing(engine, start), Reach(engine, start)
        wish: Retrace | Finer | None = None
        total, number, still = 1, 0, False
        while True:
            name, before = f"{key}/{number}", (h, copy(closing), copy(reach))
            most = min(8 * settings.chunk, LARGEST // (2 * engine.n + engine.row_size))
            if reach.learned:
                most = min(settings.chunk, most)  # the longest step is decided anew for each
            known = journal.recall(name) if journal is not None else None
            if known is not None:
                chunk = Chunk(
                    *(np.asarray(known[part]) for part in OF_SOLVED),
                    status=Status(int(known["status"])),
                )
                h, still = float(known["h"]), bool(known.get("still", False))
                reach.escapes(chunk)
            else:
                room, longest = capacity, settings.max_step * reach.growth(history[-1])
                if isinstance(wish, Retrace):
                    room, longest = AGAIN, min(wish.longest, longest)
                    h = min(h, longest)
                if not engine.compiled:
                    # points are dear, and a branch that closes is found to only at the end of a chunk
                    room = min(room, max(most, FEWEST), max(AGAIN, total // 2))
                if engine.adaptive is not None:
                    room = min(room, engine.adaptive.chunk)
                room = min(room, max(settings.max_points - total, 1))
                apart = _apart(engine, max(h, longest))
                loop = motion.standing_loop if still else engine.loop
                chunk, h = _march(engine, loop, history, room, h, longest, stop_at_border)
                stuck = chunk.status == Status.STEP_TOO_SMALL and engine.moving is not None and not still
                still = stuck
                if stuck:
                    # the direction along which the mesh moves may jump where the solutions do not: for a chunk the mesh stands still
                    h = settings.first_step
                    if len(chunk) > 1:
                        chunk.status = Status.RUNNING
                    else:
                        history, still = motion.adapted(history[-1:], still), False
                        loop = motion.standing_loop
                        chunk, h = _march(engine, loop, history, room, h, longest, stop_at_border)
                closed = closing.cut(chunk, apart)
                away = reach.escapes(chunk, apart)
                if closed is not None:
                    chunk = closed
                elif away is not None:
                    chunk = chunk.cut(max(away + 1, 2))
                    chunk.status = Status.ESCAPED
                elif reach.creeps(chunk):
                    chunk.status = Status.CREEPING
                elif total + len(chunk) - 1 >= settings.max_points and chunk.status == Status.RUNNING:
                    chunk.status = Status.MAX_POINTS
                # a step that failed at once is nothing to keep: a start that is refused leaves no journal
                if len(chunk) > 1 and journal is not None and not isinstance(journal, NullJournal):
                    journal.record(
                        name, {**_kept(chunk), "status": int(chunk.status), "h": h, "still": still}
                    )
            chunk.before = history[-2] if len(history) > 1 else None
            wish = yield chunk
            number += 1
            if isinstance(wish, Finer):
                motion.release()
                last, start = wish.image(history[-1]), wish.image(closing.start)
                h, closing, reach = before  # nothing is known of the chunk
                engine, motion, still = wish.engine, MeshMotion(wish.engine), False
                history = motion.adapted([motion.steered(last)])
                for watch in (closing, reach):
                    watch.engine, watch.start = engine, start
                continue
            if wish is not None:
                chunk = chunk.cut(wish.count)
            elif chunk.status != Status.RUNNING:
                return
            total += len(chunk) - 1
            history = [chunk.solved(i) for i in range(max(0, len(chunk) - 2), len(chunk))]
            history = motion.adapted(history, still)
            capacity = settings.chunk if number == 1 else min(2 * capacity, max(settings.chunk, most))
    finally:
        motion.release()


def _kept(chunk: Chunk) -> dict[str, Any]:
    """What a journal keeps of a chunk: the loop writes to the other arrays the next time, and nobody to points and tangents."""
    values: dict[str, Any] = {part: getattr(chunk, part) for part in OF_SOLVED}
    for part in ("points", "tangents"):
        values[part] = values[part].view()
        values[part].flags.writeable = False
    return values


def _march(
    engine: Engine,
    loop: InterpretedLoop | NativeLoop,
    history: list[Solved],
    capacity: int,
    h: float,
    longest: float,
    stop_at_border: bool,
) -> tuple[Chunk, float]:
    first, n = len(history), engine.n
    size = first + capacity
    signs, corrections = np.zeros((2, size))
    points, tangents = np.empty((size, n)), np.empty((size, n + 1))
    chunk = Chunk(points, np.empty(size), tangents, engine.rows(size), signs, corrections, Status.RUNNING)
    for array, known in zip(chunk.arrays, packed(history, chunk.status).arrays, strict=True):
        array[:first] = known
    control = engine.control._replace(stop_at_border=stop_at_border, max_step=longest)
    with engine.section:
        filled, h, status = loop.march(chunk, first, float(h), control)
    return Chunk(*(array[first - 1 : filled] for array in chunk.arrays), status=Status(status)), float(h)


def _apart(engine: Engine, longest: float) -> float:
    """The largest distance of neighbours after steps of at most this length; of a user's step rule nothing is known.

    The rule allows an error of angle < 1 times the length, and the step to the end of the interval may be 1.5^2 times as long.
    """
    return 4.5 * longest if engine.settings.step_rule is BY_ANGLE else np.inf


class Point(NamedTuple):
    """A point of a branch, as ``trace`` yields it.

    ``multipliers`` are those of the full period (eigenvalues for flows), ``margin`` is the smallest margin, ``stable`` is
    None where stability is not computed, ``status`` is empty but for the last point, where it says why the branch ends.
    """

    u: np.ndarray
    value: float
    tangent: np.ndarray
    multipliers: np.ndarray
    margin: float
    stable: bool | None
    status: str


@hinting
def trace(
    problem: Problem,
    within: tuple[float, float],
    u: np.ndarray | None = None,
    p: float | None = None,
    direction: float = 1.0,
    settings: Settings | dict[str, Any] | None = None,
    stop_at_border: bool = False,
    over: str | None = None,
) -> Iterator[Point]:
    """The points of a branch, one by one; the caller's loop decides when to stop.

    Nothing is looked for between the points. Special points, and steps to another branch where two nearly touch, are found by
    ``diagram`` with ``depth=0``.

    Parameters
    ----------
    problem : Problem or orbit
        A problem, or an object with ``problem(parameter)`` and ``seed(problem) -> (u, p)`` as for ``diagram``.
    within : (float, float)
        Interval of the parameter.
    u, p : optional
        Start; the orbit's own, or the problem's ``u0``, ``p0``, if left out.
    direction : float
        Positive: begin with increasing parameter.
    settings : Settings or dict, optional
    stop_at_border : bool
        End with the first point that has a negative margin.
    over : str, optional
        Name of the continuation parameter, for an orbit.

    Yields
    ------
    Point

    Raises
    ------
    ValueError
        If the interval is no interval, the start is outside of it, or does not converge.
    """
    from .starts import check_interval, problem_and_start, solve_start

    problem, begin, p = problem_and_start(problem, over, u, p)
    settings = Settings.of(settings)
    engine = Engine(problem, check_interval(within), settings)
    start = solve_start(engine, begin, p)
    if start.tangent[-1] * direction < 0.0:
        start = start._replace(tangent=-start.tangent, sign=-start.sign)
    first = True
    walk = chunks(engine, start, stop_at_border=stop_at_border)
    while True:
        with listening():
            chunk = next(walk, None)
        if chunk is None:
            return
        multipliers = engine.multipliers(chunk.rows)
        stable = engine.stable(chunk.rows).tolist() if engine.tells_stability else [None] * len(chunk)
        ends = [""] * len(chunk)
        if chunk.status != Status.RUNNING:
            ends[-1] = chunk.status.sentence(problem.parameter, float(chunk.values[-1]))
        points = zip(
            chunk.points.copy(),
            chunk.values.tolist(),
            chunk.tangents.copy(),
            multipliers,
            engine.smallest_margin(chunk.rows).tolist(),
            stable,
            ends,
        )
        yield from itertools.starmap(Point, itertools.islice(points, 0 if first else 1, None))
        first = False


class MeshMotion:
    """The motion of the mesh of an engine's problem; where it has no mesh, points stay as they are.

    Parameters
    ----------
    engine : Engine
    """

    def __init__(self, engine: Engine) -> None:
        self.engine, self.moving, self.adaptive = engine, engine.moving, engine.adaptive

    @cached_property
    def standing_loop(self) -> InterpretedLoop | NativeLoop:
        """The loop of a mesh that stands where it is."""
        return self.engine.loop_with(self.engine.metric._replace(moving=None))

    def steered(self, point: Solved) -> Solved:
        """The point, with the direction along which the mesh moves with the solution."""
        return point if self.moving is None else self._along(point, self.moving.steer)

    def standing(self, point: Solved) -> Solved:
        """The point, with the direction along which the mesh stands where it is."""
        return point if self.moving is None else self._along(point, self.moving.stand)

    def _along(self, point: Solved, change: Callable[[np.ndarray, np.ndarray], None]) -> Solved:
        tangent = point.tangent.copy()
        change(point.u, tangent)
        return point._replace(tangent=self.engine.unit(tangent))

    def carried(self, u: np.ndarray, other: np.ndarray, tangent: np.ndarray) -> np.ndarray | None:
        """Unknowns as they read on the mesh of those of the next point, where the mesh was adapted between both; else None.

        There the way from one to the other is not along the tangent.
        """
        if self.moving is None:
            return None
        engine = self.engine
        chord, direction = engine.join(other - u, 0.0), engine.join(tangent[:-1], 0.0)
        along = engine.inner(direction, chord) > ALONG * engine.norm(chord) * engine.norm(direction)
        return None if along else self.moving.carried(u, other)

    def adapted(self, history: list[Solved], still: bool = False) -> list[Solved]:
        """The last points of a branch; where the mesh, or the phase that is kept, no longer suits the last one, that one alone, on a mesh that does.

        So it is, too, where the mesh is to stand still.
        """
        engine, problem = self.engine, self.adaptive
        if problem is None:
            return history
        last, image = history[-1], problem.adapted(history[-1].u)
        if image is None and problem.in_phase(last.u) and not still:
            return history
        problem.anchor(last.u, last.p)
        last = self.standing(last)
        if image is not None:
            u, direction = image(last.u), image(last.tangent[:-1], True)
            problem.anchor(u, last.p)
            found = engine.across(u, last.p, engine.unit(engine.join(direction, float(last.tangent[-1]))))
            if found is None or self._past_a_border(last, found):
                # a border is met with the next steps on the mesh on which it is not there yet
                problem.anchor(last.u, last.p)
            else:
                last = found
        return [last if still else self.steered(last)]

    def _past_a_border(self, before: Solved, after: Solved) -> bool:
        margin = self.engine.smallest_margin
        return bool(margin(before.row) >= 0.0 > margin(after.row))

    def solved(self, guess: Solved) -> Solved | None:
        """The solution across the tangent of a guess, in phase with that."""
        assert self.adaptive is not None
        self.adaptive.anchor(guess.u, guess.p)
        guess = self.standing(guess)
        found = self.engine.across(guess.u, guess.p, guess.tangent)
        found = None if found is None else self.steered(found)
        self.adaptive.anchor(None)
        return found

    def release(self) -> None:
        """Keep the phase of no solution any more."""
        if self.adaptive is not None:
            self.adaptive.anchor(None)
