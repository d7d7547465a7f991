"""The atlas: one graph of all attractors that simulation finds, each traced with the branches connected to it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, TypeVar

import numpy as np

from ..bifurcation.kind import Kind
from ..continuation.settings import Settings, hinting
from ..graph import Graph
from ..graph.automatic import new_run
from ..graph.builder import finish, leave_waiting, limit_reached, tell_waiting
from ..graph.run import Run, WorkState
from ..journal import Journal
from ..long_work import Asked, OnInterrupt, Tell, carried_out, listening
from ..problems.abilities import Population
from .census import CountedMotion, census, join, population_of
from .effort import BUDGET, Effort
from .places import Handover, scattered_value, unknown, unresolved, untested_values
from .settings import ATLAS
from .windows import CYCLES, Windows, separate_run

T = TypeVar("T")
STARTS = 256  # default number of starts at each given value, for closed-form machines
FEW = 16  # starts at each further value
SOUGHT = 8  # starts at each given value for the search for cycles, stable or not, by Newton's method
# names of the kinds of work, as the message about work left undone shows them
TRACED = "values whose motions are not traced"
GIVEN, BETWEEN, SCATTERED = "given values", "values between changes", "scattered values"
ENDS = "ends of stable stretches"
WAITING = "branches that leave others"
FOLLOWED = 4  # starts that following the motion beyond one end of a stable stretch counts as
LONGEST_SCAN = 2  # largest number of scattered values, relative to `scan`


@hinting
@listening()
def atlas(
    machine: object,
    over: str | None = None,
    within: tuple[float, float] | None = None,
    values: int | Sequence[float] = 16,
    starts: int | None = None,
    seed: int = 0,
    scan: int | None = None,
    budget: int | None = None,
    depth: int = 3,
    virtual: bool = False,
    user_functions: Mapping[str, Any] | None = None,
    journal: Journal | None = None,
    progress: Asked = None,
    settings: Settings | Mapping[str, Any] | None = None,
    kinds: Sequence[Kind] | None = None,
    interrupt: OnInterrupt = "raise",
) -> Graph:
    """Compute one graph of all attractors that many simulated starts find, with the branches connected to them.

    At each value of the parameter, starts are drawn and simulated, and the periodic motions on which they settle are solved exactly. Each of
    these is a point of a known branch or the root of a new one, which is traced with all branches that leave it. The steps are:

    1. `starts` starts at each of `values`; tracing begins after all these simulations;
    2. fewer starts in each stretch between two changes of stability, wide stretches first;
    3. fewer starts at values scattered evenly over the interval, until `scan` values in a row have added no branch;
    4. at each end of a stable stretch, the motion is followed just beyond it by simulation, to the attractor that replaces it, wide stretches
       first;
    5. narrow windows: unstable cycles, found in chaos and by Newton's method from a few starts, are traced, and stable branches connected to
       them are added;
    6. steps 4 and 2 for the new branches, and values at which a kind of motion without a branch begins or ends.

    Branches that begin very near to a homoclinic orbit are not followed if the windows there are narrower than 1e-5 of the interval; the
    special points' notes say so.

    When the budget is used up, the current branch or simulation is finished, and the graph's message lists the work left out. With a file as
    journal, the same call with ``journal=contvines.resume("FILE.vines")`` and a larger budget continues.

    Parameters
    ----------
    machine : machine, orbit or problem
        A machine, an orbit, or a problem of your own with a ``population``.
    over : str, optional
        Name of the parameter.
    within : (float, float)
        Its interval.
    values : int or sequence of float
        Parameter values at which starts are simulated: a number of evenly spread values, or a list.
    starts : int, optional
        Number of starts at each value; by default 256, for a machine whose flow is integrated 32.
    seed : int
        Random seed of the starts and the scattered values; equal seeds give equal graphs.
    scan : int, optional
        Step 3 ends after this number of values in a row without a new branch, with 16 starts each. By default these values have as
        many starts as the given values together. 0 omits all steps but the first.
    budget : int, optional
        Largest amount of work, by default 500000 units, which take some minutes. One unit is a point of a branch in closed form (a point with
        many unknowns counts once per 64 unknowns, a special point of cycles as forty points) or 100 simulated forcing periods (steps of a
        map); units of a machine whose flow is integrated count twentyfold. The amount does not depend on the computer's speed or load.
        ``settings["work"]`` of the graph is the work done, ``settings["left"]`` the work left out.
    depth, virtual, user_functions, journal, progress, settings, kinds, interrupt
        As for :func:`contvines.diagram`.

    Returns
    -------
    Graph
        With ``attractors``; it may have several components.

    Raises
    ------
    ValueError
        If the interval, the values or the starts are invalid.
    """
    population = population_of(machine, over)
    if within is None:
        raise ValueError(
            f"within = None: give the interval of {population.parameter}, for example within=(0.2, 1.3)"
        )
    given_values = check_values(values, within)
    if starts is None:
        starts = max(2 * FEW, round(STARTS / population.price))
    budget = BUDGET if budget is None else budget
    _check_whole("starts", starts, 1)
    scan = -(-len(given_values) * starts // FEW) if scan is None else scan
    for name, value, least in (("seed", seed, 0), ("budget", budget, 1), ("scan", scan, 0)):
        _check_whole(name, value, least)
    asked = {"values": len(given_values), "starts": starts, "seed": seed, "scan": scan, "budget": budget}

    def start(stored: Journal, report: Tell | None) -> tuple[Graph, Callable[[], None]]:
        arguments = dict(population.about), within, depth, virtual, user_functions, stored, report, settings
        run = new_run(population.parameter, *arguments, kinds=kinds)
        run.graph.settings |= asked
        run.narrowest = ATLAS.narrow * (run.graph.within[1] - run.graph.within[0])
        return run.graph, partial(_work, _Search(run, population, seed, budget), given_values, starts, scan)

    return carried_out(start, journal, progress, interrupt)


def _work(looking: _Search, values: list[float], starts: int, scan: int) -> None:
    """Run the steps of an atlas one after another; `values` are the given values."""
    if scan:
        looking.effort.expect(SCATTERED, scan)
        looking.effort.expect(CYCLES, len(values))
    looking.given(values, starts)
    if scan:
        looking.between(scan)
        looking.everywhere(scan)
        looking.past_ends(FEW * scan)
        looking.for_cycles(values)
        looking.past_ends(FEW * scan)
        looking.between(scan)
        looking.unbranched(scan)
    looking.tell_left()
    found = sorted((counted.attractor for counted in looking.found), key=lambda attractor: attractor.value)
    looking.run.graph.attractors = found
    finish(looking.run)


def _check_whole(name: str, value: object, least: int) -> None:
    if not (isinstance(value, int) and value >= least):
        raise ValueError(f"{name} = {value!r} must be a whole number, {least} or more")


def check_values(values: int | Sequence[float], within: tuple[float, float]) -> list[float]:
    """Return the parameter values at which starts are simulated, in increasing order.

    Parameters
    ----------
    values : int or sequence of float
        Number of evenly spread values, or the values.
    within : (float, float)

    Raises
    ------
    ValueError
        If there are none, or one lies outside the interval.
    """
    low, high = within
    if isinstance(values, int):
        if values < 1:
            raise ValueError(f"values = {values}: give how many, 1 or more, or a list of values")
        inner = (np.arange(values) + 0.5) / values
        return [float(low + (high - low) * t) for t in inner]
    numbers = sorted({float(v) for v in list(values)})
    if not numbers:
        raise ValueError("values = []: give at least one, or how many")
    for v in numbers:
        if not low <= v <= high:
            raise ValueError(
                f"values: {v:g} lies outside the interval [{low:g}, {high:g}]; leave it out, or widen it"
            )
    return numbers


class _Search:
    """State of the search of an atlas: the simulated values, the motions found, and the steps of the search as methods."""

    def __init__(self, run: Run, population: Population, seed: int, budget: int) -> None:
        self.run, self.population, self.seed = run, population, seed
        self.asked: list[float] = []
        self.found: list[CountedMotion] = []
        self.handover = Handover(run, population)
        separate = separate_run(run)
        self.effort = Effort(population, budget, lambda: run.cost + separate.cost)
        self.windows = Windows(run, population, separate, self.effort)
        self.left: dict[str, int] = {}  # by kind of work, number of pieces that the budget did not allow
        run.over = lambda: self.effort.over
        run.left = lambda: WorkState(*self.effort.left())

    def pieces(self, kind: str, work: Sequence[T], least: int = 0) -> Iterator[T]:
        """Yield the pieces of one kind of work while the budget lasts, at least the first `least`; count those left out."""
        self.effort.expect(kind, len(work))
        for k, piece in enumerate(work):
            if k >= least and self._budget_spent(kind, len(work) - k):
                return
            with self.effort.piece(kind):
                yield piece

    def _budget_spent(self, kind: str, left: int) -> bool:
        """Return whether the budget is used up; if so, record that `left` pieces of this kind of work are left out."""
        if self.effort.over:
            self.left[kind] = left
        return self.effort.over

    def given(self, values: Sequence[float], starts: int) -> None:
        """Simulate starts at the given values, then trace the motions that they reach."""
        self.effort.expect(TRACED, len(values))
        found = [self.simulated(p, starts, self.seed) for p in self.pieces(GIVEN, values, 1)]
        for counted in self.pieces(TRACED, found, 1):
            join(self.run, counted)

    def simulated(self, p: float, starts: int, seed: int) -> list[CountedMotion]:
        """Simulate starts at a value and return the motions that they reach."""
        self.run.tell(f"{starts} starts at {self.population.parameter} = {p:.6g}", p)
        counted = census(self.population, p, starts, seed, self.run.journal)
        self.asked.append(p)
        self.found += counted
        return counted

    def few(self, p: float) -> int:
        """Simulate a few starts at a value, trace the motions that they reach, and return the number of branches added."""
        return join(self.run, self.simulated(p, FEW, self.seed + len(self.asked)))

    def for_cycles(self, values: Sequence[float]) -> None:
        """Find narrow windows: trace unstable cycles, from chaotic motions and from starts, back to the folds at which stable ones begin."""
        given = set(values)
        self.windows.near_chaos([counted for counted in self.found if counted.attractor.value in given])
        self.windows.around(values, SOUGHT, self.seed)
        if self.windows.left:
            self.left[CYCLES] = self.windows.left

    def between(self, most: int) -> None:
        """Simulate at one value at least in each stretch between two changes of stability, new changes included, at up to `most` values."""
        self._few(partial(untested_values, self.run.graph), most)

    def unbranched(self, most: int) -> None:
        """Simulate at up to `most` values near to which a kind of motion without a branch begins or ends."""

        def places(asked: Sequence[float], left: int) -> list[float]:
            found: dict[str, list[float]] = {}
            for counted in self.found:
                found.setdefault(counted.attractor.kind, []).append(counted.attractor.value)
            return unresolved(found, asked, self.run.graph.within, left)

        self._few(places, most)

    def _few(self, places: Callable[[Sequence[float], int], list[float]], most: int) -> None:
        while most > 0 and BETWEEN not in self.left and (wanted := places(self.asked, most)):
            most -= len(wanted)
            for p in self.pieces(BETWEEN, wanted):
                self.few(p)

    def past_ends(self, most: int) -> None:
        """Follow the motions beyond the ends of their stable stretches, those of new branches included, with at most `most` starts in all."""
        while ends := self.handover.left()[: max(most // FOLLOWED - len(self.handover.done), 0)]:
            for end in self.pieces(ENDS, ends):
                found = self.handover.follow(end)
                self.found += found
                # full depth: motions that leave the new branches are found at the ends of these
                join(self.run, found, self.run.depth)
            if self.effort.over:
                break
        left = len(self.handover.left())
        self.run.graph.settings |= {"followed": len(self.handover.done), "unfollowed": left}

    def everywhere(self, scan: int) -> None:
        """Simulate at scattered values until `scan` values in a row have added no branch."""
        fruitless = k = 0
        self.effort.expect(ENDS, len(self.handover.left()))
        while (left := min(scan - fruitless, LONGEST_SCAN * scan - k)) > 0 and not self._budget_spent(
            SCATTERED, left
        ):
            self.effort.expect(SCATTERED, left)
            with self.effort.piece(SCATTERED):
                p = scattered_value(self.run.graph.within, self.seed, k)
                added = self.few(p)
            fruitless = 0 if added else fruitless + 1
            k += 1
        self.run.graph.settings |= {"scanned": k, "quiet": fruitless}

    def tell_left(self) -> None:
        """Store the amount of work, the unknown stretches and the work left out in the graph's settings and message."""
        graph, effort = self.run.graph, self.effort
        if self.run.queue and limit_reached(self.run):  # later roots have added waiting branches
            leave_waiting(self.run)
        elif self.run.queue:
            self.left[WAITING] = len(self.run.queue)
            tell_waiting(self.run, f"budget = {effort.budget}")
        graph.settings |= {"work": effort.spent, "unknown": [list(p) for p in unknown(graph, self.asked)]}
        if self.left:
            graph.settings["left"] = dict(self.left)
            left = ", ".join(f"{kind} ({count})" for kind, count in self.left.items())
            stopped = f"stopped at budget = {effort.budget}; left out are {left}: raise budget to look on"
            graph.message, graph.complete = "; ".join(filter(None, (graph.message, stopped))), False
