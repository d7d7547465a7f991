"""Run: the state of an automatic diagram while it is built."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from ..bifurcation.detect import Detector
from ..bifurcation.kind import Kind
from ..bifurcation.kinds import KINDS, kind_named
from ..bifurcation.locate import Located
from ..branches import Ending, Reason
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine, Solved, parameter_unit
from ..continuation.settings import Settings
from ..long_work import OPEN, time_left
from ..problems.protocol import Problem
from . import Graph, Switch
from .identity import Register

if TYPE_CHECKING:
    from ..journal import Journal


LARGE = 64  # number of unknowns above which the cost of a point grows with their number
LOCATED = 40  # cost, in points, of a special point of cycles on a mesh: location, solution on a finer mesh, switching


@dataclass(frozen=True)
class Limits:
    """Functions at whose zeros branches end, bounds of measures included.

    Attributes
    ----------
    functions : dict
        name -> callable (u, p) -> float, or (measure, value).
    bounds : dict
        name of a measure -> (low, high); each finite bound is also one of the functions.
    """

    functions: dict[str, Any] = field(default_factory=dict)
    bounds: dict[str, tuple[float, float]] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        stop: Mapping[str, Any] | None,
        bounds: Mapping[str, tuple[float, float]] | None,
        problem: Problem,
    ) -> Limits:
        """Check the user's arguments and return the limits.

        Parameters
        ----------
        stop : mapping, optional
            name -> callable (u, p) -> float, or (measure, value).
        bounds : mapping, optional
            measure -> (low, high); either may be infinite or None.
        problem : Problem
            Problem whose measures may have bounds.

        Raises
        ------
        ValueError
            If a bound is no pair of increasing numbers, or there is no such measure.
        """
        functions, pairs = dict(stop or {}), {}
        for name, pair in (bounds or {}).items():
            names = problem.measure_names
            if name not in names:
                raise ValueError(f"bounds: there is no measure {name!r}; choose from {', '.join(names)}")
            try:
                low, high = (
                    float(default if value is None else value)
                    for value, default in zip(pair, (-math.inf, math.inf), strict=True)
                )
            except (TypeError, ValueError):
                raise ValueError(
                    f"bounds: {name!r} has {pair!r}; give two numbers, low and high (None where there is no bound)"
                ) from None
            if not low < high:
                raise ValueError(
                    f"bounds: {name!r} has [{low:g}, {high:g}]; the first one must be the smaller one"
                )
            pairs[name] = (low, high)
            functions |= {f"{name} = {end:g}": (name, end) for end in (low, high) if math.isfinite(end)}
        return cls(functions, pairs)

    def kept(self) -> dict[str, Any]:
        """Return the bounds as a JSON-able dict for the settings of a graph."""
        pairs = {
            name: [end if math.isfinite(end) else None for end in pair] for name, pair in self.bounds.items()
        }
        return {"bounds": pairs} if pairs else {}

    def outside(self, problem: Problem, u: np.ndarray, p: float) -> str:
        """Return a sentence on the first bound that a solution violates; empty if it lies within all."""
        for name, (low, high) in self.bounds.items():
            value = float(problem.measures((name,), np.atleast_2d(u), np.array([p]))[name][0])
            if not low <= value <= high:
                return f"{name} = {value:.6g} is outside of its bounds [{low:g}, {high:g}]"
        return ""


NO_LIMITS = Limits()


class Origin(StrEnum):
    """How a branch was reached."""

    START = "start"  # the start of the diagram: followed in both directions
    SWITCH = "switch"  # first points of a branch that leaves a special point
    BORDER = "border"  # a solution on the other side of a border: followed in both directions
    ROOT = "root"  # a more symmetric solution that a side branch has met: followed in both directions
    REST = "rest"  # the same equations beyond a border: followed in one direction


@dataclass
class Pending:
    """A branch that waits to be traced.

    Attributes
    ----------
    problem : Problem
    u, p : ndarray, float
        Start, or a guess of it.
    tangent : ndarray or None
        Tangent at the start.
    kind : Origin
    depth : int
        Number of switches used so far.
    source : str or None
        Label of the branch from which it was reached.
    point : str or None
        Label of the special point at which it was reached.
    note : str
        Note of the switch.
    real : bool or None
        Whether the branch is real; None if its margins decide.
    origin, ahead, back : Solved or None
        The special point, and the first points of a departure; for REST the border.
    first_step : float or None
    reached : bool
        True if a branch of these solutions has been traced in the meantime: it has reached the border from the other side.
    """

    problem: Problem
    u: np.ndarray
    p: float
    tangent: np.ndarray | None = None
    kind: Origin = Origin.START
    depth: int = 0
    source: str | None = None
    point: str | None = None
    note: str = ""
    real: bool | None = None
    origin: Solved | None = None
    ahead: Solved | None = None
    back: Solved | None = None
    first_step: float | None = None
    reached: bool = False


Found = TypeVar("Found")


class WorkState(NamedTuple):
    """State of an atlas's work."""

    budget: float
    """Used share of the budget."""
    done: int
    """Number of pieces of work that are done."""
    known: int
    """Number of pieces of work known so far, those done included."""
    seconds: float
    """Estimated time for the others; NaN if none is done."""


class Progress(NamedTuple):
    """Progress of a run: a sentence and counts."""

    message: str
    branches: int
    special: int
    points: int
    value: float
    waiting: int
    left: WorkState | None = None
    """State of an atlas's work; None for a diagram."""

    @property
    def sentence(self) -> str:
        """The progress in one line."""
        line = (
            f"{self.message}  |  {self.branches} branch{'' if self.branches == 1 else 'es'}, {self.special} special points, "
            f"{self.points} points, {self.waiting} waiting"
        )
        if (left := self.left) is not None:
            line += f"; {left.done} of {left.known} pieces of work known so far{time_left(left.seconds)}, {left.budget:.0%} of the budget"
        return line


@dataclass(eq=False)
class Run:
    """State of a run: graph, queue, register of known branches, labels.

    Attributes
    ----------
    graph : Graph
        Filled in place.
    settings : Settings
    journal : Journal
    depth : int
        Largest number of switches.
    virtual : bool
        Whether branches are followed beyond borders.
    user_functions : mapping or None
    progress : callable or None
        Called with each `Progress`.
    limits : Limits
        Functions at whose zeros branches end.
    kinds : sequence of Kind
        Kinds of special points to find.
    left : callable or None
        Returns the state of an atlas's work.
    over : callable
        Returns True if an atlas must not follow further branches.
    narrowest : float
        Branches that leave others nearer than this to a homoclinic orbit, in the parameter, are not followed.
    serial : int
        Number of the current branch in the journal's entries.
    points : int
        Number of points so far.
    cost : int
        Cost so far, in points: one with many unknowns counts as unknowns / `LARGE` points, a special point of cycles as `LOCATED` points.
    queue : deque of Pending
    register : Register
        Known branches.
    numbers : dict of int
        Last number of the labels, by prefix.
    events : dict of Located
        Located events of the special points found in this run, by label.
    detectors : dict of Detector
        By the id of the problem.
    forms : dict
        Canonical forms of special points, by label.
    compared : dict
        Results of comparisons of borders.
    """

    graph: Graph
    settings: Settings
    journal: Journal
    depth: int
    virtual: bool
    user_functions: Mapping[str, Any] | None
    progress: Callable[[Progress], None] | None
    limits: Limits = NO_LIMITS
    kinds: Sequence[Kind] = KINDS
    left: Callable[[], WorkState] | None = None
    over: Callable[[], bool] = lambda: False
    narrowest: float = 0.0
    serial: int = 0
    points: int = 0
    cost: int = 0
    queue: deque[Pending] = field(default_factory=deque)
    register: Register = field(default_factory=Register)
    numbers: dict[str, int] = field(default_factory=dict)
    events: dict[str, Located] = field(default_factory=dict)
    detectors: dict[int, Detector] = field(default_factory=dict)
    forms: dict[str, tuple[SpecialPoint, Any]] = field(default_factory=dict)
    compared: dict[tuple[int, int], tuple[Solved, SpecialPoint, bool]] = field(default_factory=dict)

    def tell(self, message: str, value: float) -> None:
        """Report progress."""
        if self.progress is not None:
            graph = self.graph
            self.progress(
                Progress(
                    message,
                    len(graph.branches),
                    len(graph.special),
                    self.points,
                    value,
                    len(self.queue),
                    None if self.left is None else self.left(),
                )
            )

    def checkpoint(self) -> None:
        """Store the current graph in the journal."""
        self.journal.checkpoint(self.graph)

    def unit(self, p: float) -> float:
        """Return the unit of parameter differences near p; see :func:`contvines.continuation.engine.parameter_unit`."""
        for detector in self.detectors.values():
            return detector.engine.parameter_unit(p)
        return parameter_unit(self.graph.within, p)

    def detector(self, problem: Problem) -> Detector:
        """Return the detector of a problem, made once."""
        if id(problem) not in self.detectors:
            functions = {**(self.user_functions or {}), **self.limits.functions}
            engine = Engine(problem, self.graph.within, self.settings)
            self.detectors[id(problem)] = Detector(
                engine, self.kinds, functions, tuple(self.limits.functions)
            )
        return self.detectors[id(problem)]

    def engine(self, problem: Problem) -> Engine:
        """Return the engine of a problem, made once."""
        return self.detector(problem).engine

    def kind(self, name: str) -> Kind:
        """Return the kind of this name: one of the run's kinds, or a built-in one."""
        return kind_named(name, {kind.name: kind for kind in self.kinds})

    def new_label(self, prefix: str) -> str:
        """Return the next label with this prefix that the graph does not have yet."""
        while True:
            self.numbers[prefix] = self.numbers.get(prefix, 0) + 1
            label = f"{prefix}{self.numbers[prefix]}"
            if label not in self.graph:
                return label

    def connect(self, point: str | None, source: str | None, target: str, note: str = "") -> None:
        """Add a switch unless these two branches are already connected at this point."""
        if point is None or source is None:
            return
        for switch in self.graph.switches:
            if switch.point == point and {switch.source, switch.target} == {source, target}:
                return
        self.graph.switches.append(Switch(point, source, target, self.graph.special[point].kind, note))

    def form(self, point: SpecialPoint) -> tuple[Hashable, np.ndarray]:
        """Return the canonical form of a special point, computed once."""
        computed = self.forms.get(point.label)
        if computed is None or computed[0] is not point:
            computed = self.forms[point.label] = (point, point.attached.canonical(point.u, point.value))
        return computed[1]

    def merge(self, label: str, remaining: str) -> None:
        """Merge two special points that are the same; the label `remaining` remains."""
        graph = self.graph
        for branch in graph.branches.values():
            if any(mark == label for _, mark in branch.marks):
                branch.marks = tuple((i, remaining if mark == label else mark) for i, mark in branch.marks)
                first, last = (self._redirected(ending, label, remaining) for ending in branch.endings)
                branch.endings = (first, last)
            if branch.seed == label:
                branch.seed = remaining
        for pending in self.queue:
            if pending.point == label:
                pending.point = remaining
        switches = [replace(s, point=remaining) if s.point == label else s for s in graph.switches]
        graph.switches.clear()
        for switch in switches:
            self.connect(switch.point, switch.source, switch.target, switch.note)
        del graph.special[label]

    def _redirected(self, ending: Ending, label: str, remaining: str) -> Ending:
        """Return an ending at a point that has been merged into another one."""
        if ending.point != label:
            return ending
        if ending.reason is Reason.REACHES:
            return replace(
                ending, reason=Reason.MEETS, point=remaining, other=self.graph.special[remaining].branch
            )
        return replace(ending, point=remaining)

    def attempt(self, label: str, name: str, work: Callable[[], Found], otherwise: Found) -> Found:
        """Return the result of work at a special point; if it fails, add a remark with the error to the point, and return `otherwise`.

        Parameters
        ----------
        label : str
            Label of the special point.
        name : str
            Name of the work, for the remark.
        work : callable
            Without arguments.
        otherwise : object
            Result if the work fails.

        Raises
        ------
        KeyboardInterrupt, MemoryError, OSError
            Passed on from the work, as they do not concern a single point.
        """
        try:
            with OPEN:
                return work()
        except (MemoryError, OSError):
            raise
        except Exception as error:
            with OPEN:  # an interrupt during the work may be the cause
                self.remark(label, f"{name} failed: {type(error).__name__}: {error}")
            return otherwise

    def remark(self, label: str, sentence: str) -> None:
        """Add a sentence to the remarks on a special point, if there is one."""
        special = self.graph.special[label]
        if sentence and sentence not in special.remarks:
            special.remarks = (*special.remarks, sentence)
