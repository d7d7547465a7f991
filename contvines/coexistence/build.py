"""The atlas: simulated attractors joined to one graph, until nothing that simulation finds is missing on it."""

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
from ..graph.run import Left, Run
from ..journal import Journal
from ..long_work import Asked, OnInterrupt, Tell, carried_out, listening
from ..problems.abilities import Population
from .census import Counted, census, join, population_of
from .effort import BUDGET, Effort
from .places import Handover, scattered, unasked, unknown, unresolved
from .settings import ATLAS
from .windows import CYCLES, Windows, run_apart

T = TypeVar("T")
STARTS = 256  # at each of the given values where no number is given, in closed form
FEW = 16  # starts at each of the further values
SOUGHT = 8  # starts at each given value from which cycles are looked for, stable or not
TRACED = "values whose motions are not traced"
GIVEN, BETWEEN, SCATTERED = "given values", "values between changes", "scattered values"
ENDS = "ends of stable stretches"
WAITING = "branches that leave others"
FOLLOWED = 4  # starts that follow the motion past an end of stability
LONGEST_SCAN = 2  # times `scan` values at most, where every stretch holds something new


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
    """One graph with every attractor that many simulated starts find, and all that is connected to them.

    At each value starts are drawn, simulated, and what they settle on is solved: it is then a point of a known branch,
    exactly, or the root of a new one, which is traced with everything that leaves it. The search begins with the motions that most starts reach:

    1. `starts` starts at each of `values`, all of them before the first motion is traced;
    2. fewer starts in every stretch between two changes of what is known to be stable, wide stretches first;
    3. fewer starts at values scattered evenly over the interval, until `scan` values in a row have met nothing new;
    4. past every end of a stable stretch the motion that is lost there is followed to what comes after it, wide stretches first;
    5. narrow windows: unstable cycles, from chaos and from a few starts, are traced, and kept where they lead to a stable one;
    6. steps 4 and 2 for what is new, and values where a kind of motion without a branch begins or ends.

    So near to a homoclinic orbit that only narrow windows fit between, 1e-5 of the interval, what leaves a branch is not followed; special points say so.

    When the budget is used up, the branch or the simulation at hand is finished, and the message of the graph says what is left out. A file keeps what was
    computed: the same call with ``journal=contvines.resume("FILE.vines")`` and a larger budget goes on from there.

    Parameters
    ----------
    machine : machine, orbit or problem
        A machine, an orbit, or a problem of your own with a ``population``.
    over : str, optional
        Name of the parameter.
    within : (float, float)
        Its interval.
    values : int or sequence of float
        Where starts are simulated: so many evenly spread values, or these.
    starts : int, optional
        How many at each value; by default 256, of a machine whose flow is integrated 32.
    seed : int
        Of the starts and the further values; equal seeds give equal graphs.
    scan : int, optional
        So many further values in a row must meet nothing new, with 16 starts each. By default they have as many starts as the given values
        together. 0 leaves them out and all else that looks beyond the given values: unstable cycles, ends of stability that are followed to what
        comes after them, stretches between two changes.
    budget : int, optional
        Work that the atlas may take, by default 500000, which is some minutes: so many points of branches in closed form (one of many unknowns counts as
        often as it has 64, a special point of cycles as forty points), or a hundred times as many simulated periods (steps of a map); those of a machine whose flow is integrated count twentyfold. It does not depend on the computer's speed or
        load; ``settings["work"]`` of the graph says how much of it was used, and ``settings["left"]`` what it left out.
    depth, virtual, user_functions, journal, progress, settings, kinds, interrupt
        As for :func:`contvines.diagram`.

    Returns
    -------
    Graph
        With ``attractors``; it may have several components.

    Raises
    ------
    ValueError
        If the interval, the values or the starts will not do; the sentence says why.
    """
    population = population_of(machine, over)
    if within is None:
        raise ValueError(
            f"within = None: give the interval of {population.parameter}, for example within=(0.2, 1.3)"
        )
    where = check_values(values, within)
    if starts is None:
        starts = max(2 * FEW, round(STARTS / population.price))
    budget = BUDGET if budget is None else budget
    _check_whole("starts", starts, 1)
    scan = -(-len(where) * starts // FEW) if scan is None else scan
    for name, value, least in (("seed", seed, 0), ("budget", budget, 1), ("scan", scan, 0)):
        _check_whole(name, value, least)
    asked = {"values": len(where), "starts": starts, "seed": seed, "scan": scan, "budget": budget}

    def begun(kept: Journal, tell: Tell | None) -> tuple[Graph, Callable[[], None]]:
        about = dict(population.about), within, depth, virtual, user_functions, kept, tell, settings
        run = new_run(population.parameter, *about, kinds=kinds)
        run.graph.settings |= asked
        run.narrowest = ATLAS.narrow * (run.graph.within[1] - run.graph.within[0])
        return run.graph, partial(_work, _Looking(run, population, seed, budget), where, starts, scan)

    return carried_out(begun, journal, progress, interrupt)


def _work(looking: _Looking, where: list[float], starts: int, scan: int) -> None:
    """The steps of an atlas, one after another."""
    if scan:
        looking.effort.expect(SCATTERED, scan)
        looking.effort.expect(CYCLES, len(where))
    looking.given(where, starts)
    if scan:
        looking.between(scan)
        looking.everywhere(scan)
        looking.past_ends(FEW * scan)
        looking.for_cycles(where)
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
    """The values at which starts are simulated, in increasing order.

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


class _Looking:
    """What has been simulated so far, and where next."""

    def __init__(self, run: Run, population: Population, seed: int, budget: int) -> None:
        self.run, self.population, self.seed = run, population, seed
        self.asked: list[float] = []
        self.found: list[Counted] = []
        self.handover = Handover(run, population)
        apart = run_apart(run)
        self.effort = Effort(population, budget, lambda: run.cost + apart.cost)
        self.windows = Windows(run, population, apart, self.effort)
        self.left: dict[str, int] = {}  # pieces of work that the budget did not allow
        run.over = lambda: self.effort.over
        run.left = lambda: Left(*self.effort.left())

    def pieces(self, what: str, things: Sequence[T], least: int = 0) -> Iterator[T]:
        """The pieces of a search one by one while the budget lasts, at least so many; those that are left out are counted."""
        self.effort.expect(what, len(things))
        for k, thing in enumerate(things):
            if k >= least and self._over(what, len(things) - k):
                return
            with self.effort.piece(what):
                yield thing

    def _over(self, what: str, left: int) -> bool:
        """Whether the budget is used up; then so many pieces of work are left out."""
        if self.effort.over:
            self.left[what] = left
        return self.effort.over

    def given(self, values: Sequence[float], starts: int) -> None:
        """Simulate starts at the given values, then trace what they reach."""
        self.effort.expect(TRACED, len(values))
        met = [self.simulated(p, starts, self.seed) for p in self.pieces(GIVEN, values, 1)]
        for counted in self.pieces(TRACED, met, 1):
            join(self.run, counted)

    def simulated(self, p: float, starts: int, seed: int) -> list[Counted]:
        """Simulate starts at a value."""
        self.run.tell(f"{starts} starts at {self.population.parameter} = {p:.6g}", p)
        counted = census(self.population, p, starts, seed, self.run.journal)
        self.asked.append(p)
        self.found += counted
        return counted

    def few(self, p: float) -> int:
        """Simulate a few starts at a value, and trace what they reach; the number of branches that this has added."""
        return join(self.run, self.simulated(p, FEW, self.seed + len(self.asked)))

    def for_cycles(self, values: Sequence[float]) -> None:
        """Follow unstable cycles, out of the chaos that has been met and from elsewhere, to where they are born with a stable one."""
        given = set(values)
        self.windows.beside([counted for counted in self.found if counted.attractor.value in given])
        self.windows.around(values, SOUGHT, self.seed)
        if self.windows.left:
            self.left[CYCLES] = self.windows.left

    def between(self, most: int) -> None:
        """One value at least in each stretch between two changes, new changes included, up to `most` values."""
        self._few(partial(unasked, self.run.graph), most)

    def unbranched(self, most: int) -> None:
        """Values where a kind of motion without a branch begins or ends, up to `most`."""

        def places(asked: Sequence[float], left: int) -> list[float]:
            met: dict[str, list[float]] = {}
            for counted in self.found:
                met.setdefault(counted.attractor.kind, []).append(counted.attractor.value)
            return unresolved(met, asked, self.run.graph.within, left)

        self._few(places, most)

    def _few(self, places: Callable[[Sequence[float], int], list[float]], most: int) -> None:
        while most > 0 and BETWEEN not in self.left and (wanted := places(self.asked, most)):
            most -= len(wanted)
            for p in self.pieces(BETWEEN, wanted):
                self.few(p)

    def past_ends(self, most: int) -> None:
        """Follow what is lost at the ends of stable stretches, those of what it leads to included, until `most` starts have been in all."""
        while ends := self.handover.left()[: max(most // FOLLOWED - len(self.handover.done), 0)]:
            for end in self.pieces(ENDS, ends):
                found = self.handover.follow(end)
                self.found += found
                join(self.run, found, self.run.depth)  # what leaves its branches is met at their ends
            if self.effort.over:
                break
        left = len(self.handover.left())
        self.run.graph.settings |= {"followed": len(self.handover.done), "unfollowed": left}

    def everywhere(self, scan: int) -> None:
        """Scattered values until `scan` of them in a row have added nothing."""
        quiet = k = 0
        self.effort.expect(ENDS, len(self.handover.left()))
        while (left := min(scan - quiet, LONGEST_SCAN * scan - k)) > 0 and not self._over(SCATTERED, left):
            self.effort.expect(SCATTERED, left)
            with self.effort.piece(SCATTERED):
                p = scattered(self.run.graph.within, self.seed, k)
                added = self.few(p)
            quiet = 0 if added else quiet + 1
            k += 1
        self.run.graph.settings |= {"scanned": k, "quiet": quiet}

    def tell_left(self) -> None:
        """Keep how much work was done, and say what the budget and the choice of values leave out."""
        graph, effort = self.run.graph, self.effort
        if self.run.queue and limit_reached(self.run):  # later roots have left more of them waiting
            leave_waiting(self.run)
        elif self.run.queue:
            self.left[WAITING] = len(self.run.queue)
            tell_waiting(self.run, f"budget = {effort.budget}")
        graph.settings |= {"work": effort.spent, "unknown": [list(p) for p in unknown(graph, self.asked)]}
        if self.left:
            graph.settings["left"] = dict(self.left)
            left = ", ".join(f"{what} ({count})" for what, count in self.left.items())
            stopped = f"stopped at budget = {effort.budget}; left out are {left}: raise budget to look on"
            graph.message, graph.complete = "; ".join(filter(None, (graph.message, stopped))), False
