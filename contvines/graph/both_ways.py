"""Following a branch both ways from its first point, on meshes that suit both."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import replace

from ..branches.ending import Ending, Reason
from ..branches.finer_mesh import Meshes
from ..branches.half_branch import HalfBranch
from ..branches.opening import from_border
from ..branches.tracing import trace_half
from ..continuation.engine import Engine, Solved
from ..continuation.layout import Status
from .run import Origin, Pending, Run

DEAD = (Status.STEP_TOO_SMALL, Status.NOT_EVALUABLE)  # why a branch may end at its very start


def followed(
    run: Run, pending: Pending, first: Solved, real: bool, label: str
) -> tuple[HalfBranch, tuple[Ending, Ending], bool]:
    """The whole branch in order, why it ends at either side, and whether it is closed.

    Where what was found on a coarse mesh cannot be read on a finer one, that side of the branch is followed again from its start. What is known
    of the pending branch is on the mesh of the result then.
    """
    engine, detector = run.engine(pending.problem)
    meshes = Meshes(run.engine, engine, detector)

    def halves(engine: Engine, first: Solved, known: Container[str]) -> dict[str, HalfBranch]:
        return _halves(run, meshes, engine, pending, first, real, label, known)

    def again(engine: Engine, wanted: Engine, first: Solved) -> Solved | None:
        begin = _moved(meshes, engine, wanted, pending, first)
        run.serial += begin is not None
        return begin

    found, engine, first = meshes.followed(engine, first, halves, again, real)
    finest = next(iter(found.values())).engine
    first = _moved(meshes, engine, finest, pending, first, solve=False) or first
    return _in_order(pending, found, first)


def _halves(
    run: Run,
    meshes: Meshes,
    engine: Engine,
    pending: Pending,
    first: Solved,
    real: bool,
    label: str,
    known: Container[str],
) -> dict[str, HalfBranch]:
    """The parts of a branch on both sides of its first point, or on one of them, but for those that are known; the first alone where that closes."""

    def notice(points: int, value: float) -> None:
        run.tell(f"{label}: {points} points", value)

    if pending.kind is Origin.START and first.tangent[-1] < 0.0:
        first = _turned(first)
    origin, starts = None, {"ahead": first, "back": _turned(first)}
    if pending.kind is Origin.REST:
        del starts["back"]
    elif pending.kind is Origin.SWITCH:
        assert pending.origin is not None
        origin, sides = pending.origin, {"ahead": pending.ahead, "back": pending.back}
        starts = {
            side: point
            for side, point in sides.items()
            if point is not None and engine.lower <= point.p <= engine.upper
        }
    halves: dict[str, HalfBranch] = {}
    for side, start in starts.items():
        if side in known:
            continue
        detector, place = meshes.detectors[engine], f"{run.serial}/{side}"
        half = halves[side] = trace_half(
            engine, start, detector, run.journal, place, real, pending.first_step, notice, origin, meshes
        )
        if half.status == Status.CLOSED and side == "ahead":
            return {side: half}
    return halves


def _turned(point: Solved) -> Solved:
    return point._replace(tangent=-point.tangent, sign=-point.sign)


def _moved(
    meshes: Meshes, engine: Engine, wanted: Engine, pending: Pending, first: Solved, solve: bool = True
) -> Solved | None:
    """The first point on a finer mesh, and the pending branch, too; None, and all as it was, where the point cannot be solved there."""
    begin = meshes.moved(engine, wanted, first, solve)
    if begin is None:
        return None
    pending.problem, pending.u = wanted.problem, begin.u
    pending.tangent = begin.tangent if pending.tangent is not None else None
    pending.origin = meshes.moved(engine, wanted, pending.origin, solve=False)
    pending.ahead = meshes.moved(engine, wanted, pending.ahead, solve)
    pending.back = meshes.moved(engine, wanted, pending.back, solve)
    return begin


def _in_order(
    pending: Pending, halves: dict[str, HalfBranch], first: Solved
) -> tuple[HalfBranch, tuple[Ending, Ending], bool]:
    """The whole branch in order, why it ends at either side, and whether it is closed."""
    ahead, back = halves.get("ahead"), halves.get("back")
    if ahead is not None and ahead.status == Status.CLOSED:
        whole = ahead
        if pending.kind is Origin.SWITCH:
            assert ahead.first is not None
            whole = ahead.since(ahead.first)
        return whole, (_ending(ahead), _ending(ahead)), True
    if ahead is not None and back is not None:
        return back.reversed().extended(ahead, skip=1), (_ending(back), _ending(ahead)), False
    if pending.kind is Origin.REST:
        assert ahead is not None
        ahead = from_border(ahead.engine, ahead, first)
        return ahead, (_beginning(pending, Reason.GOES_ON), _ending(ahead)), False
    if ahead is not None:
        return ahead, (_beginning(pending, Reason.LEAVES), _ending(ahead)), False
    assert back is not None
    return back.reversed(), (_ending(back), _beginning(pending, Reason.LEAVES)), False


def _beginning(pending: Pending, reason: Reason) -> Ending:
    return Ending(reason, pending.p, pending.point, pending.source)


def _ending(half: HalfBranch) -> Ending:
    found = Ending.of(half.status, half.end)
    if half.status in DEAD:
        problem, stuck = half.engine.problem, half.status == Status.STEP_TOO_SMALL
        return replace(found, text=problem.explain_end(*half.at(len(half) - 1), stuck))
    return found
