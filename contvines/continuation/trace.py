"""Trace a branch: `chunks` generates chunks of points from the loop, ``trace`` single points for users."""

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


LARGEST = (
    2_000_000  # largest number of floats in a chunk; chunks grow up to it, or to eight times the setting
)
FEWEST = 8  # least number of points in a chunk, for any number of unknowns
RETRACED = 32  # number of points that are traced again with shorter steps
LEAST_COSINE = 0.7  # between a tangent and the chord to the next point; less if the mesh was adapted between


@dataclass(frozen=True, eq=False)
class Retrace:
    """Request to `chunks`: continue from the last of the first ``count`` points of a chunk, at first with steps of at most ``longest``."""

    count: int
    longest: float


@dataclass(frozen=True, eq=False)
class Finer:
    """Request to `chunks`: continue from the beginning of a chunk with the engine of a finer mesh; ``image`` transfers points to it."""

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

    The caller may send a :class:`Retrace`, if a step of the chunk has jumped to another branch, and receives the next chunk from there; or a
    :class:`Finer`, if the mesh is too coarse, and receives the same part of the branch on a finer mesh.

    Parameters
    ----------
    engine : Engine
    start : Solved
    journal, key
        Each chunk is recalled from, and recorded in, the journal as ``key/number``.
    stop_at_border : bool
        Stop at the first point with a negative margin (which is the last one yielded).
    first_step : float, optional

    Yields
    ------
    Chunk
        The last one has a status other than RUNNING. A closed branch ends with its first point again. The rows of all
        chunks share their memory: copy those that are needed before the next chunk.
    """
    settings, bound = engine.settings, engine.upper if start.tangent[-1] > 0.0 else engine.lower
    left = (bound - start.p) * np.sign(start.tangent[-1])
    if left <= engine.settled(start.p) and start.tangent[-1] != 0.0:
        end = engine.at_value(start.u, bound, start.tangent) if left > 0.0 else None  # shorter than any step
        finer = yield packed([start] if end is None else [start, end], Status.LEFT_INTERVAL)
        if isinstance(finer, Finer):
            yield from chunks(finer.engine, finer.image(start), journal, key, stop_at_border, first_step)
        return
    motion = MeshMotion(engine)
    try:
        history = motion.adapted([motion.steered(start)])
        h, capacity = settings.first_step if first_step is None else first_step, settings.first_chunk
        closing, reach = Closing(engine, start), Reach(engine, start)
        request: Retrace | Finer | None = None
        total, number, standing = 1, 0, False
        while True:
            name, before = f"{key}/{number}", (h, copy(closing), copy(reach))
            most = min(8 * settings.chunk, LARGEST // (2 * engine.n + engine.row_size))
            if reach.learned:
                most = min(settings.chunk, most)  # the longest step is set for each chunk
            recorded = journal.recall(name) if journal is not None else None
            if recorded is not None:
                chunk = Chunk(
                    *(np.asarray(recorded[part]) for part in OF_SOLVED),
                    status=Status(int(recorded["status"])),
                )
                h, standing = float(recorded["h"]), bool(recorded.get("still", False))
                reach.escapes(chunk)
            else:
                room, longest = capacity, settings.max_step * reach.growth(history[-1])
                if isinstance(request, Retrace):
                    room, longest = RETRACED, min(request.longest, longest)
                    h = min(h, longest)
                if not engine.compiled:
                    # points are expensive, and closing of a branch is tested only at the end of a chunk
                    room = min(room, max(most, FEWEST), max(RETRACED, total // 2))
                if engine.adaptive is not None:
                    room = min(room, engine.adaptive.chunk)
                room = min(room, max(settings.max_points - total, 1))
                spacing = _largest_spacing(engine, max(h, longest))
                loop = motion.standing_loop if standing else engine.loop
                chunk, h = _march(engine, loop, history, room, h, longest, stop_at_border)
                stuck = chunk.status == Status.STEP_TOO_SMALL and engine.moving is not None and not standing
                standing = stuck
                if stuck:
                    # the motion of the mesh may be discontinuous where the solutions are smooth: fix the mesh for one chunk
                    h = settings.first_step
                    if len(chunk) > 1:
                        chunk.status = Status.RUNNING
                    else:
                        history, standing = motion.adapted(history[-1:], standing), False
                        loop = motion.standing_loop
                        chunk, h = _march(engine, loop, history, room, h, longest, stop_at_border)
                closed = closing.cut(chunk, spacing)
                away = reach.escapes(chunk, spacing)
                if closed is not None:
                    chunk = closed
                elif away is not None:
                    chunk = chunk.cut(max(away + 1, 2))
                    chunk.status = Status.ESCAPED
                elif reach.creeps(chunk):
                    chunk.status = Status.CREEPING
                elif total + len(chunk) - 1 >= settings.max_points and chunk.status == Status.RUNNING:
                    chunk.status = Status.MAX_POINTS
                # a chunk without a step is not recorded, so that a rejected start leaves no journal
                if len(chunk) > 1 and journal is not None and not isinstance(journal, NullJournal):
                    journal.record(
                        name, {**_stored(chunk), "status": int(chunk.status), "h": h, "still": standing}
                    )
            chunk.before = history[-2] if len(history) > 1 else None
            request = yield chunk
            number += 1
            if isinstance(request, Finer):
                motion.release()
                last, start = request.image(history[-1]), request.image(closing.start)
                h, closing, reach = before  # the state before this chunk
                engine, motion, standing = request.engine, MeshMotion(request.engine), False
                history = motion.adapted([motion.steered(last)])
                for watch in (closing, reach):
                    watch.engine, watch.start = engine, start
                continue
            if request is not None:
                chunk = chunk.cut(request.count)
            elif chunk.status != Status.RUNNING:
                return
            total += len(chunk) - 1
            history = [chunk.solved(i) for i in range(max(0, len(chunk) - 2), len(chunk))]
            history = motion.adapted(history, standing)
            capacity = settings.chunk if number == 1 else min(2 * capacity, max(settings.chunk, most))
    finally:
        motion.release()


def _stored(chunk: Chunk) -> dict[str, Any]:
    """Return the arrays of a chunk for a journal; points and tangents, which nobody changes, as read-only views, so that they need no copy."""
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
    """March from the last points of a branch; return a chunk, and the next step."""
    first, n = len(history), engine.n
    size = first + capacity
    signs, corrections = np.zeros((2, size))
    points, tangents = np.empty((size, n)), np.empty((size, n + 1))
    chunk = Chunk(points, np.empty(size), tangents, engine.rows(size), signs, corrections, Status.RUNNING)
    for array, earlier in zip(chunk.arrays, packed(history, chunk.status).arrays, strict=True):
        array[:first] = earlier
    control = engine.control._replace(stop_at_border=stop_at_border, max_step=longest)
    with engine.section:
        filled, h, status = loop.march(chunk, first, float(h), control)
    return Chunk(*(array[first - 1 : filled] for array in chunk.arrays), status=Status(status)), float(h)


def _largest_spacing(engine: Engine, longest: float) -> float:
    """Return a bound of the distance of neighbouring points after steps of at most this length; inf for a user-defined step rule.

    The built-in rule allows an error of angle < 1 times the length, and the step to the end of the interval may be 1.5^2 times as long.
    """
    return 4.5 * longest if engine.settings.step_rule is BY_ANGLE else np.inf


class Point(NamedTuple):
    """A point of a branch, from ``trace``.

    Attributes
    ----------
    u : ndarray, shape (N,)
        Unknowns.
    value : float
        Parameter value.
    tangent : ndarray, shape (N + 1,)
        Unit tangent in the metric.
    multipliers : ndarray of complex
        Multipliers of the full period (eigenvalues for flows).
    margin : float
        Smallest margin; inf without margins.
    stable : bool or None
        None if stability is not computed.
    status : str
        At the last point: a sentence on why the branch ends. Else empty.
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
    """Generate the points of a branch one by one; the caller's loop decides when to stop.

    Special points are not sought, nor are steps detected that jump to another branch where two nearly touch; use ``diagram`` with ``depth=0``
    for these.

    Parameters
    ----------
    problem : Problem or orbit
        A problem, or an object with ``problem(parameter)`` and ``seed(problem) -> (u, p)`` as for ``diagram``.
    within : (float, float)
        Interval of the parameter.
    u, p : optional
        Start; by default the orbit's own, or the problem's ``u0`` and ``p0``.
    direction : float
        Positive to begin with increasing parameter, negative with decreasing.
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
        If the interval is invalid, the start is outside of it, or does not converge.
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
    """Motion of the mesh of an engine's problem along a branch; without a mesh, points are not changed.

    Parameters
    ----------
    engine : Engine
    """

    def __init__(self, engine: Engine) -> None:
        self.engine, self.moving, self.adaptive = engine, engine.moving, engine.adaptive

    @cached_property
    def standing_loop(self) -> InterpretedLoop | NativeLoop:
        """Loop with a fixed mesh."""
        return self.engine.loop_with(self.engine.metric._replace(moving=None))

    def steered(self, point: Solved) -> Solved:
        """Return the point with the tangent in which the mesh moves with the solution."""
        return point if self.moving is None else self._with_tangent(point, self.moving.steer)

    def standing(self, point: Solved) -> Solved:
        """Return the point with the tangent in which the mesh is fixed."""
        return point if self.moving is None else self._with_tangent(point, self.moving.stand)

    def _with_tangent(self, point: Solved, change: Callable[[np.ndarray, np.ndarray], None]) -> Solved:
        """Return the point with a changed tangent, of unit length."""
        tangent = point.tangent.copy()
        change(point.u, tangent)
        return point._replace(tangent=self.engine.unit(tangent))

    def carried(self, u: np.ndarray, other: np.ndarray, tangent: np.ndarray) -> np.ndarray | None:
        """Return unknowns transferred to the mesh of the next point, if the mesh was adapted between both; else None.

        Adaptation shows in that the chord between the points is not along the tangent.

        Parameters
        ----------
        u, other : ndarray, shape (N,)
            Unknowns of both points.
        tangent : ndarray, shape (N + 1,)
            Tangent at the first one.
        """
        if self.moving is None:
            return None
        engine = self.engine
        chord, direction = engine.join(other - u, 0.0), engine.join(tangent[:-1], 0.0)
        along = engine.inner(direction, chord) > LEAST_COSINE * engine.norm(chord) * engine.norm(direction)
        return None if along else self.moving.carried(u, other)

    def adapted(self, history: list[Solved], standing: bool = False) -> list[Solved]:
        """Adapt the mesh to the last point of a branch.

        Returns the last points unchanged if mesh and phase still suit the last one; else only the last one, with its new mesh and phase. With `standing`
        the mesh is fixed for the next steps.
        """
        engine, problem = self.engine, self.adaptive
        if problem is None:
            return history
        last, image = history[-1], problem.adapted(history[-1].u)
        if image is None and problem.in_phase(last.u) and not standing:
            return history
        problem.anchor(last.u, last.p)
        last = self.standing(last)
        if image is not None:
            u, direction = image(last.u), image(last.tangent[:-1], True)
            problem.anchor(u, last.p)
            found = engine.across(u, last.p, engine.unit(engine.join(direction, float(last.tangent[-1]))))
            if found is None or self._past_a_border(last, found):
                # keep the old mesh, on which the border is still ahead
                problem.anchor(last.u, last.p)
            else:
                last = found
        return [last if standing else self.steered(last)]

    def _past_a_border(self, before: Solved, after: Solved) -> bool:
        """Whether a point has lost its positive margins by adaptation of the mesh."""
        margin = self.engine.smallest_margin
        return bool(margin(before.row) >= 0.0 > margin(after.row))

    def solved(self, guess: Solved) -> Solved | None:
        """Solve for the solution in the plane orthogonal to the tangent of a guess, with the guess's phase; None without convergence."""
        assert self.adaptive is not None
        self.adaptive.anchor(guess.u, guess.p)
        guess = self.standing(guess)
        found = self.engine.across(guess.u, guess.p, guess.tangent)
        found = None if found is None else self.steered(found)
        self.adaptive.anchor(None)
        return found

    def release(self) -> None:
        """Remove the phase condition."""
        if self.adaptive is not None:
            self.adaptive.anchor(None)
