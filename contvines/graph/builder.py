"""Build an automatic diagram, branch by branch. The order is deterministic, so that a repeated run with a journal finds all recorded results.

For each pending branch of the run's queue: `new_branch` solves for its first point and compares it with known branches, `follow_both_ways` traces it in both
directions, :func:`~contvines.graph.label_special_points.mark` labels its special points, and :func:`~contvines.graph.schedule_branches.leave` queues
the branches that leave them, :func:`~contvines.graph.match_borders.cross` those beyond borders.
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ..bifurcation.detect import Detector
from ..bifurcation.kinds import BORDERS
from ..bifurcation.scan import sizes_by_sort
from ..bifurcation.settings import LOCATING
from ..branches import Ending, Reason
from ..branches.half_branch import HalfBranch, Meshes, make_branch, with_points_between
from ..branches.tracing import from_border, on_real_side, trace_half
from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN, Status
from ..continuation.starts import solve_start, start_remark
from ..long_work import listening, take
from ..problems.protocol import Problem
from .identity import separates_further_on
from .label_special_points import mark, origin_index
from .match_borders import is_border, same_border, tell_dead_end, tie_borders
from .run import LARGE, LOCATED, Origin, Pending, Run
from .schedule_branches import SWITCHING, leave

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

DEAD = (Status.STEP_TOO_SMALL, Status.NOT_EVALUABLE)  # statuses by which a branch may end at its first point
# a real branch whose smallest margins are all below this (negative) number is rounding, and is dropped
REAL_FROM = 0.1 * MARGIN

OFFSET = 0.7  # distance of the first point from a special point at which a diagram is started, in first steps


def begin(run: Run, problem: Problem, u: ArrayLike, p: float, depth: int = 0) -> None:
    """Solve for the start of a diagram and queue its branch.

    Parameters
    ----------
    run : Run
    problem : Problem
    u, p
        Guess of the start.
    depth : int
        Number of switches that count as used already.

    Raises
    ------
    ValueError
        If the start does not converge, lies outside the interval, or has a negative margin and ``virtual`` is off.
    """
    engine = run.engine(problem)
    start = solve_start(engine, u, p)
    outside = run.limits.outside(problem, start.u, start.p)
    if outside:
        raise ValueError(f"at the start {outside}; widen them, or start elsewhere")
    margin = float(engine.smallest_margin(start.row))
    if margin < MARGIN and not run.virtual:
        j = int(np.argmin(engine.margins(start.row)))
        raise ValueError(
            f"the start at {problem.parameter} = {start.p:.10g} is beyond a border ({problem.margin_kind(j)}, "
            f"margin {margin:.3g}), so no machine can follow it; start elsewhere or set virtual = true"
        )
    run.graph.start = start_remark(engine, u, p, start)
    run.queue.append(Pending(problem, start.u, start.p, start.tangent, depth=depth))


def adopt(run: Run) -> None:
    """Register the branches that the run's graph has already."""
    for branch in run.graph.branches.values():
        if branch.problem is not None:
            run.register.add(branch, run.engine(branch.problem), {i for i, _ in branch.marks})
    run.serial = len(run.graph.branches)


def work(run: Run) -> None:
    """Trace queued branches until the queue is empty, a limit is reached, or `run.over()`.

    The graph is not marked as finished, as an atlas adds further starts; see `finish`.
    """
    graph, before = run.graph, len(run.graph.branches)
    graph.finished = False
    with listening():
        try:
            while run.queue:
                if limit_reached(run):
                    leave_waiting(run)
                    break
                if run.over() and len(graph.branches) > before:
                    break
                trace_pending(run, run.queue.popleft())
            tie_borders(run)
            crossed = {link.point for link in (*graph.switches, *run.queue)}
            for point in graph.special.values():
                # solutions beyond this border were found, but all were rejected
                unexplained = point.kind in BORDERS and point.real and not point.remarks
                if unexplained and point.label not in crossed and point.problem is not None:
                    tell_dead_end(run, point)
        except KeyboardInterrupt:
            take()
            graph.message = "interrupted; run the same command again to go on"
            run.checkpoint()
            raise


def finish(run: Run) -> None:
    """Mark the graph as finished and store it; called once, at the end of the run."""
    graph = run.graph
    graph.finished = True
    if graph.complete:
        graph.message = "finished"
    with listening():
        run.checkpoint()
    run.tell(graph.message, float("nan"))


def limit_reached(run: Run) -> str:
    """Return the name of the setting whose limit is reached; empty if none is."""
    branches = run.graph.branches.values()
    if len(branches) >= run.settings.max_branches:
        return "max_branches"
    return "max_unknowns" if sum(b.points.size for b in branches) >= run.settings.max_unknowns else ""


def leave_waiting(run: Run) -> None:
    """End a graph at its limit: set its message, and remarks at the special points that waiting branches leave."""
    limit, graph = limit_reached(run), run.graph
    most = getattr(run.settings, limit)
    graph.complete = False
    graph.message = (
        f"stopped at {limit} = {most} with {len(run.queue)} branches waiting: "
        f"the graph is not complete; raise {limit}, or lower depth"
    )
    if most > 1:  # with max_branches = 1 the user expects no others
        tell_waiting(run, f"{limit} = {most}")


def tell_waiting(run: Run, reason: str) -> None:
    """Add a remark to each special point that a waiting branch leaves: the reason why it is not followed."""
    for pending in run.queue:
        if pending.point is not None and not pending.reached:
            run.remark(pending.point, f"a branch that leaves here is not followed: {reason}")


def trace_pending(run: Run, pending: Pending) -> None:
    """Trace a pending branch unless it is known, and queue the branches that leave it."""
    if pending.reached:
        return
    if pending.point is None:
        opened = new_branch(run, pending)
    else:
        opened = run.attempt(pending.point, SWITCHING, partial(new_branch, run, pending), None)
    if opened is not None:
        trace_new(run, pending, *opened)


def new_branch(run: Run, pending: Pending) -> tuple[Solved, bool] | None:
    """Return the first point of a pending branch and whether it is real; None if there is no branch to trace, or it is known."""
    first = first_point(run, run.engine(pending.problem), pending)
    # the virtual continuation of a branch keeps its equations, even if it repeats a shorter solution at the border
    rest = pending.kind is Origin.REST and not pending.real
    shorter = None if first is None or rest else pending.problem.root(first.u, first.p)
    if first is not None and shorter is not None:
        # a solution that only repeats a shorter one is followed as that one
        pending.problem, pending.u = shorter
        pending.p, pending.tangent = first.p, None
        if pending.kind is Origin.REST:  # a virtual branch has reached the border of the shorter solutions
            pending.kind, pending.real = Origin.BORDER, None
        elif pending.kind is Origin.SWITCH:
            pending.kind = Origin.ROOT
        first = first_point(run, run.engine(pending.problem), pending)
    if first is None:
        return None
    if outside := run.limits.outside(pending.problem, first.u, first.p):
        if pending.point is not None:
            run.remark(pending.point, f"the branch that leaves here is not followed: {outside}")
        return None
    engine = run.engine(pending.problem)
    real = pending.real
    if real is None:
        real = float(engine.smallest_margin(first.row)) >= MARGIN
    if not real and pending.kind is Origin.START and pending.tangent is not None:
        # the start is real; its correction by rounding is not, as the margins jump there: one without friction, over friction
        border, z = engine.weights * pending.tangent, engine.join(pending.u, pending.p)
        first = engine.polish(pending.u, pending.p, border, float(border @ z), pending.tangent) or first
        real = float(engine.smallest_margin(first.row)) >= MARGIN
    if not real and pending.kind is Origin.BORDER:
        return None  # a virtual solution beyond the border: no crossing
    if not real and not run.virtual:
        if pending.point is not None:
            run.remark(pending.point, "the branch that leaves here begins beyond a border; it is virtual")
        return None
    match = run.register.find(pending.problem, first.u, first.p, real)
    if match is not None and pending.kind is Origin.SWITCH and match.label == pending.source:
        match_engine = run.engine(match.attached)
        match = None if separates_further_on(match, match_engine, engine, first) else match
    if match is not None:
        if pending.kind is Origin.BORDER and pending.point is not None and match.label == pending.source:
            run.remark(pending.point, "the solution found beyond lies on the same branch")
            return None
        if pending.kind in (Origin.BORDER, Origin.REST) and pending.point is not None:
            pending.point = same_border(run, pending.point, match)
        run.connect(pending.point, pending.source, match.label, pending.note)
        return None
    return first, real


def trace_new(run: Run, pending: Pending, first: Solved, real: bool) -> None:
    """Trace a new branch, label its special points, and queue the branches that leave it."""
    run.serial += 1
    label = run.new_label("B")
    half, endings, closed = follow_both_ways(run, pending, first, real, label)
    if pending.kind is Origin.START and len(half) == 1 and not closed and half.status in DEAD:
        name = pending.problem.parameter
        raise ValueError(
            f"the branch ends at its first point, {name} = {first.p:.10g}, in every direction: "
            + "; ".join(dict.fromkeys(ending.sentence(name) for ending in endings))
        )
    few = pending.kind is Origin.REST and len(half) < 4
    if few and np.ptp(half.joined().values) < run.settings.same * run.unit(first.p):
        run.numbers["B"] -= 1
        run.remark(str(pending.point), "the equations cannot be followed beyond the border")
        return
    if pending.kind is Origin.BORDER and has_no_length(run, half):
        run.numbers["B"] -= 1
        return  # the border's own solution once more: no crossing
    if pending.kind is Origin.BORDER and begins_elsewhere(run, half, pending):
        run.numbers["B"] -= 1
        run.remark(str(pending.point), "a solution found nearby lies on a branch that does not begin here")
        return
    origin = origin_index(half, pending)
    whole = with_points_between(half, origin)
    if whole is not half:
        half, origin = whole, origin_index(whole, pending)
    engine = half.engine
    branch = make_branch(label, half, real, endings, closed, pending.point)
    run.graph.branches[label] = branch
    run.register.add(branch, engine, {i for i, _ in half.events} | {origin})
    run.connect(pending.point, pending.source, label, pending.note)
    new = mark(run, branch, half, pending, origin)
    for point in new:
        leave(run, point, branch, pending.depth)
    run.points += len(branch)
    solved = len(branch) + (LOCATED * len(new) if engine.adaptive else 0)
    run.cost += max(solved, solved * engine.n // LARGE)
    run.checkpoint()
    run.tell(f"{label} finished", float(branch.values[-1]))


# ------------------------------------------------------------------ both directions
def follow_both_ways(
    run: Run, pending: Pending, first: Solved, real: bool, label: str
) -> tuple[HalfBranch, tuple[Ending, Ending], bool]:
    """Follow a branch in both directions; return it in order, its two endings, and whether it is closed.

    A side whose points cannot be transferred to a finer mesh is followed again from its start. The pending branch is then changed to the mesh
    of the result.
    """
    meshes = Meshes(run.detector(pending.problem), run.detector)

    def notice(points: int, value: float) -> None:
        run.tell(f"{label}: {points} points", value)

    def halves(detector: Detector, first: Solved, done: Container[str]) -> dict[str, HalfBranch]:
        """Follow the sides of the first point, except those known already; if the first side closes, only that one."""
        if pending.kind is Origin.START and first.tangent[-1] < 0.0:
            first = turned(first)
        origin, starts = None, {"ahead": first, "back": turned(first)}
        if pending.kind is Origin.REST:
            del starts["back"]
        elif pending.kind is Origin.SWITCH:
            engine, origin = detector.engine, pending.origin
            sides = {"ahead": pending.ahead, "back": pending.back}
            starts = {side: at for side, at in sides.items() if at and engine.lower <= at.p <= engine.upper}
        found: dict[str, HalfBranch] = {}
        for side, start in starts.items():
            if side not in done:
                place = f"{run.serial}/{side}"
                found[side] = trace_half(
                    detector, start, run.journal, place, real, pending.first_step, notice, origin, meshes
                )
                if found[side].status == Status.CLOSED and side == "ahead":
                    break
        return found

    def moved(detector: Detector, wanted: Detector, first: Solved, solve: bool = True) -> Solved | None:
        """Transfer the first point and the pending branch to a finer mesh; None, without changes, if the point cannot be solved there."""
        begin = meshes.moved(detector, wanted, first, solve)
        if begin is not None:
            pending.problem, pending.u = wanted.engine.problem, begin.u
            pending.tangent = begin.tangent if pending.tangent is not None else None
            pending.origin = meshes.moved(detector, wanted, pending.origin, solve=False)
            pending.ahead = meshes.moved(detector, wanted, pending.ahead, solve)
            pending.back = meshes.moved(detector, wanted, pending.back, solve)
        return begin

    def restarted(detector: Detector, wanted: Detector, first: Solved) -> Solved | None:
        """Transfer the first point to a finer mesh, under a new number of the journal's entries."""
        begin = moved(detector, wanted, first)
        run.serial += begin is not None
        return begin

    found, detector, first = meshes.followed(first, halves, restarted, real)
    finest = next(iter(found.values())).detector
    first = moved(detector, finest, first, solve=False) or first
    return _in_order(pending, found, first)


def turned(point: Solved) -> Solved:
    """Return a point with its tangent reversed."""
    return point._replace(tangent=-point.tangent, sign=-point.sign)


def _in_order(
    pending: Pending, halves: dict[str, HalfBranch], first: Solved
) -> tuple[HalfBranch, tuple[Ending, Ending], bool]:
    """Join the half branches in order; return the branch, its endings, and whether it is closed."""
    ahead, back = halves.get("ahead"), halves.get("back")
    reason = Reason.GOES_ON if pending.kind is Origin.REST else Reason.LEAVES
    begins = Ending(reason, pending.p, pending.point, pending.source)
    if ahead is None:
        assert back is not None
        return back.reversed(), (_ending(back), begins), False
    end = _ending(ahead)
    if ahead.status == Status.CLOSED:
        if pending.kind is Origin.SWITCH:
            assert ahead.first is not None
            ahead = ahead.since(ahead.first)
        return ahead, (end, end), True
    if back is not None:
        return back.reversed().extended(ahead, skip=1), (_ending(back), end), False
    return from_border(ahead, first) if pending.kind is Origin.REST else ahead, (begins, end), False


def _ending(half: HalfBranch) -> Ending:
    """Return the ending of a half branch, with the problem's explanation if it died."""
    found = Ending.of(half.status, half.end)
    if half.status in DEAD:
        problem, stuck = half.engine.problem, half.status == Status.STEP_TOO_SMALL
        return replace(found, text=problem.explain_end(*half.at(len(half) - 1), stuck))
    return found


# ------------------------------------------------------------------ first points
def has_no_length(run: Run, half: HalfBranch) -> bool:
    """Whether a branch has no length but for rounding, or is real by rounding only."""
    nowhere = run.settings.rounding
    whole, unit = half.joined(), run.unit(half.end)
    length = whole.values.max() - whole.values.min()
    if len(half) > 2 and whole.smallest[1:-1].max() < REAL_FROM:
        return True
    if length > run.settings.located * unit:
        return False
    engine, extent = half.engine, np.append(np.ptp(whole.points, axis=0), 0.0)
    return bool(
        whole.smallest.max() <= nowhere or (length <= nowhere * unit and engine.norm(extent) <= nowhere)
    )


def begins_elsewhere(run: Run, half: HalfBranch, pending: Pending) -> bool:
    """Whether a branch found beyond a border ends at other borders in both directions, so that it does not begin at this one."""
    ends = {i: e for i, e in half.events if i in (0, len(half) - 1) and e.kind in BORDERS}
    return len(ends) == 2 and not any(
        is_border(run, half.engine.problem, e, str(pending.point)) for e in ends.values()
    )


def first_point(run: Run, engine: Engine, pending: Pending) -> Solved | None:
    """Compute the first regular point of a pending branch; None, with a remark at its special point, if there is none inside the interval."""
    if pending.kind is Origin.SWITCH:
        _move_nearer(engine, pending)
        first = pending.ahead
        if first is not None and not engine.lower <= first.p <= engine.upper:
            first = pending.back
        if first is not None and not engine.lower <= first.p <= engine.upper:
            first = None
    elif pending.kind is Origin.REST:
        first = pending.origin
        if first is not None and pending.real and pending.first_step is None:
            pending.first_step = shortened_step(engine, first, run.settings.first_step)
    else:
        first = engine.start(pending.u, pending.p, pending.tangent)
        if first is not None:
            step, side = 0.0, True if pending.kind is Origin.BORDER else None
            if pending.kind is Origin.ROOT and pending.tangent is None:
                # move off the point where the known branch ends, or the new branch is mistaken for it; but not past a border
                step = run.settings.amplitude
                margin = float(engine.smallest_margin(first.row))
                side = margin >= MARGIN if abs(margin) > run.settings.inside else None
            elif at_special_point(run, engine, first):
                # move off a special point, or it is detected on neither half; by less than a step, so that it differs from the second point
                step = OFFSET * run.settings.first_step
            if step > 0.0:
                first = neighbouring_point(engine, first, step, side)
    if first is None and pending.point is not None:
        run.remark(pending.point, "no branch could be started from here inside the interval")
    return first


def at_special_point(run: Run, engine: Engine, first: Solved) -> bool:
    """Whether a start is a fold, a branch point or a point where a multiplier crosses the circle."""
    if abs(first.tangent[-1]) <= run.settings.stationary * run.unit(first.p) or first.sign == 0.0:
        return True

    def on_circle(point: Solved | None) -> bool:
        return point is not None and bool((np.abs(sizes_by_sort(engine, point.row)) <= LOCATING.past).any())

    step = run.settings.first_step  # in conservative systems multipliers are on the circle at all points
    return on_circle(first) and not any(
        on_circle(point_at_distance(engine, first, side)) for side in (step, -step)
    )


def _move_nearer(engine: Engine, pending: Pending) -> None:
    """Move the first points of a departure so near to the special point that they are not behind a border."""
    origin, sides = pending.origin, (pending.ahead, pending.back)
    if origin is None:
        return
    pending.ahead, pending.back = (on_real_side(engine, origin, side) for side in sides)
    for before, point in zip(sides, (pending.ahead, pending.back)):
        if point is not None and point is not before:
            step = engine.distance(origin, point)
            pending.first_step = min(pending.first_step or step, step)


def shortened_step(engine: Engine, border: Solved, step: float) -> float | None:
    """Return a shorter first step from a border that ends at a real point, if the usual step does not; else None.

    The branch may be real in a short window only.
    """
    for length in (step, 0.1 * step, 0.01 * step, 0.001 * step):
        found = point_at_distance(engine, border, length)
        if found is not None and float(engine.smallest_margin(found.row)) >= MARGIN:
            return None if length == step else length
    return None


def neighbouring_point(engine: Engine, point: Solved, step: float, real: bool | None) -> Solved:
    """Return a point of the same branch at a small distance, ahead if possible; real or virtual as `real` says, if not None.

    Returns the given point if there is none.
    """
    for length in (step, 0.1 * step, 0.01 * step):
        for side in (length, -length):
            found = point_at_distance(engine, point, side)
            if found is None:
                continue
            if real is None or (float(engine.smallest_margin(found.row)) >= MARGIN) == real:
                return found
    return point


def point_at_distance(engine: Engine, point: Solved, step: float) -> Solved | None:
    """Return the point of the same branch at a small distance; None if it lies outside the interval."""
    found = engine.beside(point, step)
    return found if found is not None and engine.lower <= found.p <= engine.upper else None
