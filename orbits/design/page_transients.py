"""Transients of declared machines from a given state or from rest; the excitation begins at once or with a frequency that rises (run-up).

`coupled_page` declares the coupled machine together with the bare oscillator (two further states), for excitations without a closed form.
Its equations, parameters and units are those of `orbits.machines.coupled`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from orbits.contacts import HIT
from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.wall import Wall
from orbits.design.record import settled
from orbits.flows import simulator_of
from orbits.flows.page.measures import Impacts, farthest, friction_work
from orbits.flows.page.simulator import PageTrajectory
from orbits.flows.page.stepper import TWO_PI
from orbits.flows.protocol import SimulationError
from orbits.machines.names import usual
from orbits.machines.page.machine import Machine
from orbits.machines.page.page import Named, States
from orbits.machines.page.run_up import phase_at_end, run_up
from orbits.symbols import cos, sin

if TYPE_CHECKING:
    from orbits.symbols import Plain


# shortest and longest simulation in forcing periods; the length is doubled until all states have settled
FIRST, LONGEST = 120, 1920
PER_PERIOD = 80  # samples per period
MOST_EVENTS = 1_000_000  # in one simulation


@dataclass(frozen=True, eq=False)
class PageTransient:
    """A simulated transient, in the units of the machine file.

    Attributes
    ----------
    times : float array (n,)
    states : dict of float array (n,)
        Name -> values at `times`.
    largest : dict of float
        Name -> largest absolute value, including those between the samples.
    impact_times, impact_speeds, impulses : float array (k,)
        Times, speeds (m/s) and impulses (N s) of impacts; without units if the machine file has none. `impulses` is empty unless the machine declares its energy.
    settled : dict of float
        Name -> time from which on the largest absolute value of every period stays within 5 % of that of the last periods; nan if the state does not settle.
    energy : float array (n,) or None
        Energy of all bodies; None unless the machine declares it.
    taken_times, impacts, friction : float array (m,)
        Energy that impacts and friction have dissipated until these times; empty unless the machine declares its energy.
    """

    times: np.ndarray
    states: dict[str, np.ndarray]
    largest: dict[str, float]
    impact_times: np.ndarray
    impact_speeds: np.ndarray
    impulses: np.ndarray
    settled: dict[str, float]
    energy: np.ndarray | None
    taken_times: np.ndarray
    impacts: np.ndarray
    friction: np.ndarray

    def share(self, time: float) -> float:
        """Share of the initial energy that impacts and friction have dissipated until this time; nan without an initial energy."""
        if self.energy is None or not self.energy[0] > 0.0:
            return math.nan
        taken = np.interp(time, self.taken_times, self.impacts + self.friction)
        return float(taken / self.energy[0])


def page_transient(
    machine: Machine,
    params: np.ndarray,
    start: Mapping[str, float] | None = None,
    *,
    run_up_from: float | None = None,
    run_up_time: float = 0.0,
    time: float | None = None,
) -> PageTransient:
    """Simulate a machine from a state (default: rest), beginning at phase 0.

    Parameters
    ----------
    machine : Machine
    params : float array (P,)
    start : mapping, optional
        State name -> value; other states are 0.
    run_up_from, run_up_time : float, optional
        Run-up: the frequency rises linearly from `run_up_from` to that of the machine during `run_up_time`, and then stays constant.
    time : float, optional
        Duration of the simulation after the run-up. Default: until all states have settled, with 120, 240, ... 1920 forcing periods.

    Returns
    -------
    PageTransient

    Raises
    ------
    SimulationError, PageError
        If the start is impossible, the simulation fails, or `time` is missing for a self-excited machine.
    """
    if time is None and not machine.forced:
        raise SimulationError(f"{machine.name!r} is self-excited: say how long it is to be followed")
    legs: list[tuple[Machine, PageTrajectory, float]] = []
    state, begin, passed = dict(start or {}), 0.0, 0.0
    if run_up_from is not None:
        rising = run_up(machine, params, run_up_from, run_up_time)
        simulator = simulator_of(rising, params)
        simulator.put(state)
        run = simulator.run(run_up_time / TWO_PI, MOST_EVENTS)
        legs.append((rising, run, 0.0))
        state = dict(zip(machine.states, simulator.point.tolist()))
        begin, passed = phase_at_end(machine, params, run_up_from, run_up_time), run_up_time
    speed = float(machine.phase_speed(params))
    periods = FIRST if time is None else time * speed / TWO_PI
    while True:
        simulator = simulator_of(machine, params)
        simulator.put({**state, "phase": begin} if machine.forced else state)
        first = simulator.time * TWO_PI
        run = simulator.run(periods, MOST_EVENTS)
        found = _transient(machine, [*legs, (machine, run, passed - first / speed)])
        if time is not None or periods >= LONGEST or not any(map(math.isnan, found.settled.values())):
            return found
        periods *= 2


def _transient(machine: Machine, legs: list[tuple[Machine, PageTrajectory, float]]) -> PageTransient:
    """Join runs to one transient; `legs` has the machine, the trajectory and the time shift of each run."""
    times, states, energy, taken = [], [], [], []
    hits: list[tuple[float, float, float]] = []
    largest = np.zeros(machine.size)
    has_energy = machine.equations.energy is not None
    for stage, run, shift in legs:
        speed = float(stage.phase_speed(run.params))
        length = run.finish - run.clocks[0]
        period = TWO_PI if stage.forced else TWO_PI / float(machine.phase_speed(run.params))
        clocks = run.clocks[0] + np.linspace(0.0, length, max(2, math.ceil(length / period * PER_PERIOD)) + 1)
        rows = run.sample(clocks)
        times.append(clocks / speed + shift)
        states.append(rows[:, : machine.size])
        phases = np.mod(clocks, TWO_PI) if stage.forced else np.zeros(len(clocks))
        if has_energy:
            numbers = np.zeros((len(rows), len(run.params) + len(stage.equations.signed)))
            numbers[:, : len(run.params)] = run.params
            energy.append(stage.compiled.energy()(rows, phases, numbers)[:, 0])
        ends = np.append(run.clocks[1:], run.finish)
        for i, (begin, end) in enumerate(zip(run.clocks, ends)):
            turn = TWO_PI * math.floor(begin / TWO_PI) if stage.forced else 0.0
            span, lost = (begin - turn, end - turn), 0.0
            if i and run.events[i - 1][1] == HIT:
                wall = run.events[i - 1][0]
                clock = np.array([span[0] if stage.forced else 0.0])
                impact = Impacts(stage, wall, run.states[i : i + 1], clock, run.params[None])
                hits.append((begin / speed + shift, float(impact.speeds[0]), float(impact.impulses[0])))
                lost = float(impact.losses[0])
            sizes = np.abs(farthest(stage, run.modes[i], run.states[i], *span, run.params)).max(axis=0)
            largest = np.maximum(largest, sizes[: machine.size])
            rubbed = (
                friction_work(stage, run.modes[i], run.states[i], *span, run.params)
                if has_energy and stage.equations.limit
                else 0.0
            )
            taken.append((begin / speed + shift, lost, 0.0))
            taken.append((end / speed + shift, 0.0, rubbed))
    time, table = np.concatenate(times), np.concatenate(states)
    impacts = np.array(hits).reshape(-1, 3)
    parts = np.array(taken if has_energy else []).reshape(-1, 3)
    count = max(1, round(float(legs[-1][1].finish - legs[-1][1].clocks[0]) / TWO_PI)) if machine.forced else 0
    last = len(times[-1])
    calm = {
        name: float(time[-last]) + settled(time[-last:] - time[-last], table[-last:, j], count)
        if count
        else math.nan
        for j, name in enumerate(machine.states)
    }
    return PageTransient(
        time,
        dict(zip(machine.states, table.T)),
        dict(zip(machine.states, largest.tolist())),
        impacts[:, 0],
        impacts[:, 1],
        impacts[:, 2] if has_energy else np.zeros(0),
        calm,
        np.concatenate(energy) if has_energy else None,
        parts[:, 0],
        np.cumsum(parts[:, 1]),
        np.cumsum(parts[:, 2]),
    )


def _motion(state: States, phase: Plain, p: Named, contact: Named) -> tuple[Plain, ...]:
    q1, _, v1, v2, bare, bare_rate = state
    damping = p.mass_ratio * p.damping
    base = p.mass_ratio * p.forcing * (sin(phase) + p.excitation * damping * p.frequency * cos(phase))
    pull = p.gravity * sin(p.slope) - contact.floor
    return (
        v1,
        v2,
        base - damping * v1 - q1 - p.mass_ratio * pull,
        pull,
        bare_rate,
        base - damping * bare_rate - bare,
    )


def _wall(letter: str, side: int) -> Wall:
    push = {"v1": lambda state, phase, p: -side * p.mass_ratio, "v2": side}
    return Wall(letter, lambda state, phase, p: 1 - side * (state.q1 - state.q2), push, "restitution")


@cache
def coupled_page() -> Machine:
    """Return the coupled machine and the bare oscillator as one declared machine, with the parameters of `orbits.Coupled`."""
    model, given = usual("coupled")
    floor = DryFriction(
        "floor", lambda s, phase, p: s.v1 - s.v2, lambda s, phase, p: p.friction * p.gravity * cos(p.slope)
    )
    return Machine(
        name="coupled_and_bare",
        states=("q1", "q2", "v1", "v2", "bare", "bare_rate"),
        parameters=model.named(model.vector(given)),
        phase_rate="frequency",
        motion=_motion,
        contacts=[_wall("L", 1), _wall("R", -1), floor],
        energy=lambda s, phase, p: 0.5 * (s.v1**2 + p.mass_ratio * s.v2**2 + s.q1**2),
    )
