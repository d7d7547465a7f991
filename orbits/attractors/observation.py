"""What a motion does in the long run: over one cycle where it recurs, else for as long as its statistics need."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.modulation import BAND, SILENT, modulation_of
from orbits.attractors.attractor import Attractor
from orbits.attractors.batches import lyapunov
from orbits.attractors.modulation import modulation
from orbits.attractors.motion import wandering
from orbits.flows.native.measures import gauged
from orbits.machines.states import state_of
from orbits.machines.stepping import EVENTS_FULL, HOLD, PSI, TIME_REACHED, TURNS
from orbits.simulation.driver import collect
from orbits.simulation.trajectory import TWO_PI, Trajectory

if TYPE_CHECKING:
    from orbits.machines.base import Model

FIRST = 4096
"""Forcing periods of the first window of a motion that does not recur; every later one doubles the whole."""
LONGEST = 16384
"""Forcing periods after which the observation ends in any case."""
SETTLED = 0.01
"""Largest relative change over the last doubling."""
OFTEN = 32
"""A motion that does not recur is `chatter` if it rests on a wall at least once in so many periods, on average."""
SOLVED = 1e-9  # largest residual of an orbit
PIECE = 256  # periods simulated at a time: bounds the memory
PER_OSCILLATION = 12  # instants between which an extremum of q1 is looked for; events come on top
MOST_EVENTS = 400  # per period


@dataclass(frozen=True)
class Observation:
    """Statistics of a motion.

    Attributes
    ----------
    periods : float
        Forcing periods looked at.
    max_abs_q1, max_abs_w, impact_speed : float
        Largest displacement of the cavity (nan in the reduced model), largest |w|, fastest approach |w'-|.
    impacts_per_period : float
        Mean number of impacts per forcing period.
    contacts : int
        How often impacts piled up into persistent contact.
    """

    periods: float
    max_abs_q1: float
    max_abs_w: float
    impact_speed: float
    impacts_per_period: float
    contacts: int

    def near(self, other: Observation) -> bool:
        """Whether two observations tell the same, up to `SETTLED`."""
        pairs = (
            (self.max_abs_q1, other.max_abs_q1),
            (self.max_abs_w, other.max_abs_w),
            (self.impact_speed, other.impact_speed),
            (self.impacts_per_period, other.impacts_per_period),
        )
        return all(np.isnan(a) or abs(a - b) <= SETTLED * max(abs(a), abs(b)) for a, b in pairs)


def observe(found: Attractor) -> Observation:
    """Statistics of a motion from `found.state`, which stays as it is.

    A motion that recurs is followed over one cycle. Another one is followed until its largest values and its mean
    number of impacts have changed by less than 1 % while the time of observation doubled: a modulated motion
    grows, bursts and fades over tens or hundreds of periods, and a few of them show only a part of that.
    """
    run = _Tally(found)
    if found.recurrent:
        return run.cycle()
    length, before = float(FIRST), run.go_on(FIRST)
    while run.moving and length < LONGEST:
        length *= 2.0
        now = run.go_on(length)
        if now.near(before):
            return now
        before = now
    return before


def lasting(found: Attractor, seen: Observation | None = None) -> Attractor:
    """The attractor with its kind and impacts as `observe` sees them; one that recurs is returned as it is."""
    if found.recurrent:
        return found
    seen = seen or observe(found)
    return replace(
        found,
        kind="chatter" if seen.contacts * OFTEN >= seen.periods else "chaotic",
        impacts_per_period=seen.impacts_per_period,
        impact_speed=seen.impact_speed,
    )


def measure_names(model: Model) -> tuple[str, ...]:
    """Measures in a sweep's rows.

    ``max_abs_w``; ``impact_speed``: fastest approach |w'-|; ``impacts_per_period``: per forcing period; in the coupled model
    ``max_abs_q1``: largest displacement of the cavity, and of motions that do not recur ``modulated_low``, ``modulated_mean``,
    ``modulated_high``: of its largest displacements in each forcing period, ``silent``: share of the periods without an impact; in the
    reduced model ``C2``: squared amplitude of its motion. Motions that do not recur are looked at until these numbers settle.
    """
    reduced = "amplitude" in model.parameter_names
    own = ("C2",) if reduced else ("max_abs_q1",)
    return (*own, "max_abs_w", "impact_speed", "impacts_per_period", *(() if reduced else (*BAND, SILENT)))


def described(found: Attractor) -> tuple[Attractor, dict[str, float]]:
    """The attractor with its kind and impacts as it is observed, and its measures by name (see `measure_names`)."""
    seen, model, params = observe(found), found.model, found.params
    known = {name: getattr(seen, name, np.nan) for name in measure_names(model)}
    if "C2" in known:
        known["C2"] = float(params[model.parameter_names.index("amplitude")]) ** 2
    elif not found.recurrent:
        known |= modulation(model, found.machine, params, found.state).measures
    return lasting(found, seen), gauged(model, params, known)


def modulated(found: Attractor, measures: Mapping[str, float]) -> str:
    """How a motion is modulated, chaotic by its largest Lyapunov exponent; empty where it recurs or nothing but the absorber moves."""
    if not modulation_of(measures):
        return ""
    growth = lyapunov(found.model.name, found.state, found.params)
    return modulation_of(measures, wandering(*growth, True) == "chaotic")


def dots(found: Attractor, measures: Mapping[str, float]) -> list[float]:
    """What a picture shows: the largest |q1|, or B at every impact."""
    return [float(measures["max_abs_q1"])] if "max_abs_q1" in measures else found.dots


class _Tally:
    """A motion simulated piece by piece, and what has been seen of it so far."""

    def __init__(self, found: Attractor) -> None:
        self.found, self.state = found, found.state.copy()
        self.begin = self._time()
        self.impacts, self.contacts, self.moving = 0, 0, True
        self.q1 = 0.0 if found.machine.moving_cavity else np.nan
        self.w = self.speed = 0.0
        frequency = float(found.params[found.model.parameter_names.index("frequency")])
        self.per_period = int(np.ceil(min(200.0, PER_OSCILLATION * max(1.0, 1.0 / frequency))))

    def cycle(self) -> Observation:
        """One cycle, of the solved orbit where there is one: the motion itself may still be on its way to it."""
        found = self.found
        if len(found.codes) and found.residual < SOLVED:
            code, mode = int(found.codes[0]), int(found.modes[0])
            self.state = state_of(found.machine, found.params, code, mode, found.nodes[0])
            self.begin = self._time()
        self._add((found.periods or 1) + 1e-9, per_period=200)  # the event it starts with comes again
        speed = self.speed if found.impacts else 0.0
        return Observation(self._lasted(), self.q1, self.w, speed, found.impacts_per_period, self.contacts)

    def go_on(self, length: float) -> Observation:
        """Simulate until `length` periods have been seen in all."""
        while self.moving and self._lasted() < length - 1e-9:
            self._add(min(PIECE, length - self._lasted()), self.per_period)
        lasted = self._lasted()
        rate = self.impacts / lasted if lasted > 0.0 else 0.0
        return Observation(lasted, self.q1, self.w, self.speed, rate, self.contacts)

    def _time(self) -> float:
        return float(self.state[TURNS] + self.state[PSI] / TWO_PI)

    def _lasted(self) -> float:
        return self._time() - self.begin

    def _add(self, periods: float, per_period: int) -> None:
        found, begin, time = self.found, self.state.copy(), self._time()
        most = int(MOST_EVENTS * (periods + 1.0))
        seen: Any = collect(found.machine, self.state, found.params, time + periods, most)
        run = Trajectory(found.model, found.params, found.machine, begin, self.state.copy(), *seen)
        hits = np.abs(run.rows[run.codes < 2, 3])
        self.impacts += hits.size
        self.contacts += int(np.count_nonzero(run.codes == HOLD))
        self.speed = max(self.speed, float(hits.max(initial=0.0)))
        reach = np.append(run.states[:, 1], run.end[1])
        if found.model.frictionless(found.params):  # turns are no events there
            reach = np.append(reach, run.sample().w)
        left, right = found.machine.walls(found.params)
        self.w = min(max(left, -right), max(self.w, float(np.abs(reach).max())))
        if found.machine.moving_cavity:
            self.q1 = max(self.q1, run.peak_cavity(per_period))
        self.moving = run.status in (TIME_REACHED, EVENTS_FULL) and self._time() > time
