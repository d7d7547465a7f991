"""Brute-force sweeps of declared machines: the attractor at one value after another, each from the state the last one left."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from orbits.contacts.letters import HIT
from orbits.contacts.wall import Wall
from orbits.declared.attractor import DeclaredAttractor, attracted
from orbits.flows.page.stepper import TWO_PI, Stepper
from orbits.machines.page.machine import Machine
from orbits.simulation.page import outside

SAMPLES = 2000  # of a motion without a period, for its extremes
NUDGE = 1e-7  # states are changed by this at each value, as noise would: an unstable motion is then left


@dataclass(frozen=True)
class DeclaredRow:
    """One value of a sweep.

    Attributes
    ----------
    value : float
    attractor : str
        As `DeclaredAttractor.kind`.
    word : str
    periods, impacts : int
        Of the cycle; 0 where nothing recurs.
    measures : dict
        `max_` and `min_` of the first state, `approach_speed`, `impacts_per_period` (of a self-excited machine: per unit of time).
    dots : list of float
        What a picture shows: the approach speed of every impact of a cycle (or of the last part of the run); of a machine without walls the
        first state's extremes.
    state : float array (n + 1,)
        Clock and states reached.
    detail : DeclaredAttractor
    """

    value: float
    attractor: str
    word: str
    periods: int
    impacts: int
    measures: dict[str, float]
    dots: list[float]
    state: np.ndarray
    detail: DeclaredAttractor = field(repr=False)


def measure_names(machine: Machine) -> tuple[str, ...]:
    """Measures in a sweep's rows."""
    first = machine.states[0]
    return (f"max_{first}", f"min_{first}", "approach_speed", "impacts_per_period")


def sweep(
    machine: Machine,
    over: str,
    values: Iterable[float],
    *,
    start: np.ndarray | None = None,
    transient: int = 200,
    max_period: int = 16,
    progress: Callable[[DeclaredRow], None] | None = None,
    **parameters: float,
) -> list[DeclaredRow]:
    """Simulate at each value in turn, each time from the state where the last one ended.

    Parameters
    ----------
    machine : Machine
    over : str
        The swept parameter.
    values : iterable of float
    start : float array (n + 1,), optional
        Clock and states at the first value; all 0 if left out.
    transient, max_period
        As for `find_attractor`.
    progress : callable, optional
        Called with each row.
    **parameters
    """
    rows = []
    here = np.zeros(machine.size + 1) if start is None else np.asarray(start, dtype=float)
    for value in values:
        params = machine.vector({**parameters, over: float(value)})
        stepper = Stepper(machine, params)
        stepper.start(outside(stepper, here[1:], float(here[0])), float(here[0]))
        stepper.state[-1] += NUDGE
        found = attracted(stepper, transient, max_period, 0)
        here = np.concatenate([[stepper.clock], stepper.state])
        row = _row(float(value), found, here)
        rows.append(row)
        if progress is not None:
            progress(row)
    return rows


def _row(value: float, found: DeclaredAttractor, state: np.ndarray) -> DeclaredRow:
    machine, orbit, first = found.machine, found.orbit, found.machine.states[0]
    if orbit is not None:
        taken = orbit.measures(*(n for n in orbit.problem().measure_names if n in measure_names(machine)))
        speeds = approaches(found, len(orbit.word))
        span = orbit.periods if machine.forced else orbit.period
        impacts = orbit.impacts
        text, periods = orbit.word.text, orbit.periods
    else:
        run = found.trajectory
        clocks = np.linspace(run.clocks[0], run.end, SAMPLES)
        x = run.sample(clocks)[:, 0]
        taken = {f"max_{first}": float(x.max()), f"min_{first}": float(x.min())}
        speeds = approaches(found, len(run))
        span = (run.end - run.clocks[0]) / (TWO_PI if machine.forced else 1.0)
        impacts, text, periods = 0, "", 0
    hits = len(speeds)
    measures = {
        f"max_{first}": taken[f"max_{first}"],
        f"min_{first}": taken[f"min_{first}"],
        "approach_speed": max(speeds, default=0.0),
        "impacts_per_period": hits / span if span > 0.0 else 0.0,
    }
    walls = any(isinstance(contact, Wall) for contact in machine.contacts)
    dots = speeds if walls else [measures[f"max_{first}"], measures[f"min_{first}"]]
    return DeclaredRow(value, found.kind, text, periods, impacts, measures, dots, state, found)


def approaches(found: DeclaredAttractor, events: int) -> list[float]:
    """Approach speeds of the impacts among the last `events` events of an attractor's run: the gap's rate after each over restitution."""
    run, machine = found.trajectory, found.machine
    speeds = []
    for k in range(len(run) - min(events, len(run)), len(run)):
        contact, kind, _ = run.events[k]
        if kind != HIT:
            continue
        clock = np.array([run.clocks[k + 1]]) if machine.forced else np.zeros(1)
        numbers = machine.compiled.numbers(run.params, run.modes[k + 1])[None]
        rate, restitution = machine.compiled.rebound(contact)(run.states[k + 1][None], clock, numbers)[0]
        speeds.append(float(rate / restitution))
    return speeds
