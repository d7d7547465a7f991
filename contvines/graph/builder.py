"""Builder: the state of an automatic diagram. Deterministic, so that a run with a journal catches up with itself."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..branch import Branch
from ..continuation.engine import Engine, Solved
from ..continuation.settings import Settings
from ..continuation.starts import solve_start
from ..continuation.status import Status
from ..events.watch import MARGIN, Watch
from ..follow import Half, follow, make_branch, single
from ..special import BORDERS, PREFIXES, SpecialPoint
from .graph import Graph, Switch
from .identity import Register
from .leaving import Leaving
from .marking import Marking
from .pending import Pending


class Progress(NamedTuple):
    """Where a run is: a sentence, and how much there is so far."""

    message: str
    branches: int
    special: int
    points: int
    value: float
    waiting: int


class Builder(Marking, Leaving):
    """Builds a graph branch by branch, breadth first.

    Parameters
    ----------
    graph : Graph
        Filled in place.
    settings : Settings
    journal : Journal
    depth : int
    virtual : bool
    user_functions : mapping or None
    progress : callable or None
    """

    def __init__(
        self,
        graph: Graph,
        settings: Settings,
        journal: Any,
        depth: int,
        virtual: bool,
        user_functions: Mapping[str, Any] | None,
        progress: Callable[[Progress], None] | None,
    ) -> None:
        self.graph, self.settings, self.journal = graph, settings, journal
        self.depth, self.virtual = depth, virtual
        self.user_functions = dict(user_functions or {})
        self.progress = progress
        self.queue: deque[Pending] = deque()
        self.register = Register()
        self.numbers: dict[str, int] = {}
        self.engines: dict[int, tuple[Any, Engine, Watch]] = {}
        self.serial = 0
        self.points = 0
        self.unit = graph.within[1] - graph.within[0]

    # ------------------------------------------------------------------ the run
    def begin(self, problem: Any, u: Any, p: float) -> None:
        """Put the start into the queue.

        Raises
        ------
        ValueError
            If it does not converge, lies outside the interval, or has a negative margin and ``virtual`` is off.
        """
        engine, _ = self.engine(problem)
        start = solve_start(engine, u, p)
        margin = float(engine.smallest_margin(start.row))
        if margin < MARGIN and not self.virtual:
            j = int(np.argmin(engine.margins(start.row)))
            raise ValueError(
                f"the start at {problem.parameter} = {start.p:.10g} is beyond a border ({problem.margin_kind(j)}, "
                f"margin {margin:.3g}), so no machine can follow it; start elsewhere or set virtual = true"
            )
        self.queue.append(Pending(problem, start.u, start.p, start.tangent))

    def adopt(self) -> None:
        """Continue the labels and the register of a graph that has branches already."""
        for branch in self.graph.branches.values():
            if branch.problem is not None:
                self.register.add(branch, self.engine(branch.problem)[0])
        self.serial = len(self.graph.branches)
        for label in [*self.graph.branches, *self.graph.special]:
            prefix = label.rstrip("0123456789")
            self.numbers[prefix] = max(self.numbers.get(prefix, 0), int(label[len(prefix) :] or 0))

    def run(self) -> None:
        """Work until the queue is empty."""
        graph = self.graph
        graph.finished = False
        try:
            while self.queue:
                if len(graph.branches) >= self.settings.max_branches:
                    graph.message = (
                        f"stopped at max_branches = {self.settings.max_branches} with {len(self.queue)} branches waiting"
                    )
                    break
                self.trace(self.queue.popleft())
        except KeyboardInterrupt:
            graph.message = "interrupted; run the same command again to go on"
            self.journal.checkpoint(graph)
            raise
        graph.finished = True
        graph.message = graph.message or "finished"
        self.journal.checkpoint(graph)
        self.tell(graph.message, float("nan"))

    def tell(self, message: str, value: float) -> None:
        """Report progress."""
        if self.progress is not None:
            graph = self.graph
            self.progress(
                Progress(message, len(graph.branches), len(graph.special), self.points, value, len(self.queue))
            )

    def engine(self, problem: Any) -> tuple[Engine, Watch]:
        """Engine and watch of a problem, made once."""
        if id(problem) not in self.engines:
            engine = Engine(problem, self.graph.within, self.settings)
            self.engines[id(problem)] = (problem, engine, Watch(engine, self.user_functions))
        _, engine, watch = self.engines[id(problem)]
        return engine, watch

    def new_label(self, prefix: str) -> str:
        """The next label with this prefix."""
        self.numbers[prefix] = self.numbers.get(prefix, 0) + 1
        return f"{prefix}{self.numbers[prefix]}"

    def connect(self, point: str | None, source: str | None, target: str, note: str = "") -> None:
        """Add a switch unless these two branches are already tied at this point."""
        if point is None or source is None:
            return
        for known in self.graph.switches:
            if known.point == point and {known.source, known.target} == {source, target}:
                return
        self.graph.switches.append(Switch(point, source, target, self.graph.special[point].kind, note))

    # ------------------------------------------------------------------ one branch
    def trace(self, pending: Pending) -> None:
        """Trace a branch unless it is known, and queue what leaves it."""
        engine, watch = self.engine(pending.problem)
        first = self.first_point(engine, pending)
        if first is None:
            return
        real = pending.real
        if real is None:
            real = float(engine.smallest_margin(first.row)) >= MARGIN
        if not real and not self.virtual:
            if pending.point is not None:
                self.remark(pending.point, "the branch that leaves here begins beyond a border; it is virtual")
            return
        known = self.register.find(pending.problem, first.u, first.p, real)
        if known is not None:
            self.connect(pending.point, pending.source, known.label, pending.note)
            return
        self.serial += 1
        label = self.new_label("B")
        half, ended, closed = self.both_ways(engine, watch, pending, first, real, label)
        branch = make_branch(label, engine, half, real, ended, closed, pending.point, self.origin_index(half, pending))
        self.graph.branches[label] = branch
        self.register.add(branch, engine)
        self.connect(pending.point, pending.source, label, pending.note)
        new = self.mark(engine, branch, half, pending)
        for point in new:
            self.leave(point, branch, pending.depth)
        self.points += len(branch)
        self.journal.checkpoint(self.graph)
        self.tell(f"{label} finished", float(branch.values[-1]))

    def first_point(self, engine: Engine, pending: Pending) -> Solved | None:
        """The first regular point of a pending branch, or None."""
        if pending.kind == "switch":
            first = pending.ahead
            if first is not None and not engine.lower <= first.p <= engine.upper:
                first = pending.back
            if first is not None and not engine.lower <= first.p <= engine.upper:
                first = None
        elif pending.kind == "rest":
            first = pending.origin
        else:
            first = engine.start(pending.u, pending.p, pending.tangent)
        if first is None and pending.point is not None:
            self.remark(pending.point, "no branch could be started from here inside the interval")
        return first

    def both_ways(
        self, engine: Engine, watch: Watch, pending: Pending, first: Solved, real: bool, label: str
    ) -> tuple[Half, tuple[str, str], bool]:
        """The whole branch in order, why it ends at either side, and whether it is closed."""
        name, key = pending.problem.parameter, str(self.serial)

        def notice(points: int, value: float) -> None:
            self.tell(f"{label}: {points} points", value)

        def go(start: Solved, side: str) -> Half:
            return follow(engine, start, watch, self.journal, f"{key}/{side}", real, pending.first_step, notice)

        def sentence(half: Half) -> str:
            return half.status.sentence(name, float(half.values[-1]))

        leaves = "" if pending.point is None else f"leaves {pending.source} at {pending.point}"
        if pending.kind == "rest":
            ahead = go(first, "ahead")
            return ahead, (f"goes on from {pending.source} at {pending.point}", sentence(ahead)), False
        if pending.kind == "switch":
            assert pending.origin is not None
            origin, beside = pending.origin, [pending.ahead, pending.back]
            sides = [
                go(point, side)
                for point, side in zip(beside, ("ahead", "back"))
                if point is not None and engine.lower <= point.p <= engine.upper
            ]
            if sides[0].status == Status.CLOSED:
                return sides[0], (sentence(sides[0]),) * 2, True
            whole = single(origin)
            if pending.back is None:
                return whole.extended(sides[0]), (leaves, sentence(sides[0])), False
            if len(sides) == 2:
                whole = sides[1].reversed().extended(whole).extended(sides[0])
                return whole, (sentence(sides[1]), sentence(sides[0])), False
            if beside[0] is first:
                return whole.extended(sides[0]), (leaves, sentence(sides[0])), False
            whole = sides[0].reversed().extended(whole)
            return whole, (sentence(sides[0]), leaves), False
        if first.tangent[-1] < 0.0 and pending.kind == "start":
            first = first._replace(tangent=-first.tangent, sign=-first.sign)
        ahead = go(first, "ahead")
        if ahead.status == Status.CLOSED:
            return ahead, (sentence(ahead), sentence(ahead)), True
        back = go(first._replace(tangent=-first.tangent, sign=-first.sign), "back")
        return back.reversed().extended(ahead, skip=1), (sentence(back), sentence(ahead)), False


def is_border(kind: str) -> bool:
    """Whether a kind of special point is a border."""
    return kind in BORDERS


__all__ = ["PREFIXES", "Branch", "Builder", "Progress", "SpecialPoint"]
