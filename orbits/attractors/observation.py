"""What a motion does in the long run: over one cycle where it recurs, else for as long as its statistics need, with its modulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from contvines.shared.motions import BAND, SILENT, modulation_of, wandering
from orbits.attractors.attractor import Attractor, Observation
from orbits.flows.catalogue import flow_of
from orbits.flows.protocol import Simulator
from orbits.flows.trajectory import TWO_PI, Trajectory
from orbits.machines.varying import Varying
from orbits.settings import SIMULATING

OFTEN = 32
"""A motion that does not recur is `chatter` if it rests on a wall at least once in so many periods, on average."""
PIECE = 256  # periods simulated at a time: bounds the memory
MOST_EVENTS = 400  # per period
PER_PERIOD = 200  # instants of a cycle
SAMPLES = 48  # instants; events come on top


def observe(found: Attractor, least: float = 0.0) -> Observation:
    """Statistics of a motion from `found.state`, which stays as it is.

    A motion that recurs is followed over one cycle. Another one is followed until its largest values and its mean
    number of impacts have changed by less than 1 % while the time of observation doubled: a modulated motion
    grows, bursts and fades over tens or hundreds of periods, and a few of them show only a part of that. Where a simulation
    takes long, the last part of that by which the motion was recognised must do, or `least` periods where these are asked for.
    """
    simulator = found.simulator()
    first, longest = simulator.observed
    tally = _Tally(simulator)
    if found.recurrent:
        seen = tally.go_on(
            (found.periods or 1) + SIMULATING.whole, PER_PERIOD
        )  # the event it starts with comes again
        speed = seen.impact_speed if found.impacts else 0.0
        return replace(seen, impact_speed=speed, impacts_per_period=found.impacts_per_period)
    if not longest:
        return tally.go_on(least) if least else tally.add(found.trajectory)
    length, before = first, tally.go_on(first)
    while tally.moving and length < longest:
        length *= 2.0
        now = tally.go_on(length)
        if now.near(before):
            return now
        before = now
    return before


def lasting(found: Attractor, seen: Observation | None = None) -> Attractor:
    """The attractor with its kind and impacts as `observe` sees them; one that recurs, or rests, is returned as it is."""
    simulator = found.simulator()
    if found.recurrent or found.kind == simulator.resting or not simulator.observed[1]:
        return found
    seen = seen or observe(found)
    kind = "chatter" if seen.contacts * OFTEN >= seen.periods else simulator.wandering
    return replace(found, kind=kind, seen=seen)


def measure_names(model: Varying) -> tuple[str, ...]:
    """Measures in a sweep's rows.

    How far the motion goes: ``max_abs_q1`` of the oscillator and ``max_abs_w`` in the cavity (in the reduced model, whose cavity is shaken as
    prescribed, ``C2``, the squared amplitude of its motion), of a declared machine ``max_`` and ``min_`` of its first state. The fastest
    approach ``impact_speed``, of a declared machine ``approach_speed``; ``impacts_per_period``: per forcing period, of a self-excited machine per unit
    of time. Where more than the absorber moves, and is forced, of motions that do not recur ``modulated_low``, ``modulated_mean``,
    ``modulated_high``: of the largest displacements in each forcing period, and ``silent``: the share of the periods without an impact.
    """
    return flow_of(model).simulated_names(model)


def described(found: Attractor, least: float = 0.0) -> tuple[Attractor, dict[str, float]]:
    """The attractor with its kind and impacts as it is observed (see `observe`), and its measures by name (see `measure_names`)."""
    model, params, orbit, flow = found.model, found.params, found.orbit, flow_of(found.model)
    names = measure_names(model)
    known = dict.fromkeys(names, np.nan)
    speed = next(name for name in names if name.endswith("_speed"))
    if orbit is not None and len(orbit.nodes) and not flow.loose(model, orbit.word):
        own = flow.measure_names(model)
        taken = orbit.measures(*(name for name in names if name in own))
        known |= {speed: 0.0, **taken, "impacts_per_period": found.impacts_per_period}
        return found, known
    seen = observe(found, least)
    rate = seen.impacts_per_period / (1.0 if model.forced else 2.0 * np.pi)
    known |= {**seen.extremes, speed: seen.impact_speed, "impacts_per_period": rate}
    simulator = found.simulator()
    if BAND[0] in names and not found.recurrent and found.kind != simulator.resting:
        periods = simulator.modulated
        run = simulator.run(periods, int(MOST_EVENTS * (periods + 1))) if periods else found.trajectory
        known |= modulation(run).measures
    return lasting(found, seen), flow.in_units(model, params, known)


def modulated(found: Attractor, measures: Mapping[str, float]) -> str:
    """How a motion is modulated, chaotic by its largest Lyapunov exponent; empty where it recurs or nothing but the absorber moves."""
    if not modulation_of(measures):
        return ""
    return modulation_of(measures, wandering(*found.simulator().growth(), True) == "chaotic")


class _Tally:
    """A motion simulated piece by piece, and what has been seen of it so far."""

    def __init__(self, simulator: Simulator) -> None:
        self.simulator, self.moving = simulator, True
        self.seen = Observation(0.0, {}, 0.0, 0.0, 0)

    def go_on(self, length: float, per_period: int = 0) -> Observation:
        """Simulate until `length` periods have been seen in all."""
        while self.moving and self.seen.periods < length - SIMULATING.whole:
            piece = min(PIECE, length - self.seen.periods)
            run = self.simulator.run(piece, int(MOST_EVENTS * (piece + 1.0)))
            self.moving = run.lasted > 0.0 and not run.stopped
            self.add(run, per_period)
        return self.seen

    def add(self, run: Trajectory, per_period: int = 0) -> Observation:
        """What has been seen with one more piece."""
        seen, extremes = self.seen, run.extremes(per_period)
        for name, value in seen.extremes.items():
            extremes[name] = (min if name.startswith("min_") else max)(value, extremes[name])
        impacts = round(seen.impacts_per_period * seen.periods) + run.impacts
        periods = seen.periods + run.lasted
        speed = max(seen.impact_speed, float(run.approaches().max(initial=0.0)))
        rate = impacts / periods if periods > 0.0 else 0.0
        self.seen = Observation(periods, extremes, speed, rate, seen.contacts + run.chatters)
        return self.seen


class Modulation(NamedTuple):
    """Of a motion, over forcing periods.

    Attributes
    ----------
    low, mean, high : float
        Of the largest displacement in a period, in the machine's own numbers.
    silent : float
        Share of the periods without an impact.
    """

    low: float
    mean: float
    high: float
    silent: float

    @property
    def measures(self) -> dict[str, float]:
        """By name."""
        return dict(zip((*BAND, SILENT), self))

    @property
    def kind(self) -> str:
        """See `contvines.shared.motions.modulation_of`."""
        return modulation_of(self.measures)


def modulation(run: Trajectory) -> Modulation:
    """Of the whole forcing periods of a run."""
    periods = max(1, int(run.lasted + SIMULATING.whole))
    clocks, sizes = run.responses(SAMPLES)
    place = ((clocks - run.clocks[0]) / TWO_PI).astype(int)
    tops = np.full(periods, -np.inf)
    np.maximum.at(tops, place[place < periods], sizes[place < periods])
    hits = ((run.clocks[1:][run.hits] - run.clocks[0]) / TWO_PI).astype(int)
    silent = 1.0 - np.unique(hits[hits < periods]).size / periods
    return Modulation(float(tops.min()), float(tops.mean()), float(tops.max()), float(silent))
