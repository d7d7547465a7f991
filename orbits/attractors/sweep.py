"""Sweeps: the attractor at each value of a parameter, the state carried on; and many starts at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from contvines.shared.near_names import no_parameter
from contvines.shared.processes import ATTEMPTS, spread
from orbits.attractors.attractor import Attractor
from orbits.attractors.observation import Observation, lasting, observe
from orbits.attractors.recurrence import find_attractor, settle
from orbits.flows.native.measures import gauged
from orbits.machines.stepping import MODE, RATE
from orbits.simulation.driver import SimulationError, collect, first_state, machine
from orbits.simulation.trajectory import Trajectory

SAME = 1e-4  # difference of the nodes of one motion met twice
PATIENCE = 2
"""How often the transient is prolonged fourfold before a motion is said not to recur: weakly damped ones settle late."""


@dataclass(frozen=True)
class SweepRow:
    """One value of a sweep.

    Attributes
    ----------
    value : float
        The swept parameter.
    direction : str
        ``up`` or ``down``.
    attractor : str
        ``periodic``, ``sliding``, ``stuck``, ``chatter`` or ``chaotic``; see `orbits.attractors.attractor.Attractor`.
    word : str
        Events of the cycle; empty where nothing recurs.
    periods, impacts : int
        k and l of the cycle; 0 where nothing recurs.
    measures : dict
        Numbers by name, the same names in every row; see `measure_names`.
    detail : Attractor
        The attractor itself, with its nodes.
    """

    value: float
    direction: str
    attractor: str
    word: str
    periods: int
    impacts: int
    measures: Mapping[str, float]
    detail: Attractor = field(repr=False)


def measure_names(model: Any) -> tuple[str, ...]:
    """Measures in a sweep's rows.

    ``max_abs_w``; ``impact_speed``: fastest approach |w'-|; ``impacts_per_period``: per forcing period; in the coupled model
    ``max_abs_q1``: largest displacement of the cavity; in the reduced model ``C2``: squared amplitude of its motion.
    Motions that do not recur are looked at until these numbers settle; see `orbits.attractors.observation`.
    """
    own = ("C2",) if "amplitude" in model.parameter_names else ("max_abs_q1",)
    return (*own, "max_abs_w", "impact_speed", "impacts_per_period")


def sweep(
    model: Any,
    over: str,
    values: Iterable[float],
    *,
    start: Mapping[str, float] | np.ndarray | None = None,
    transient: float = 200,
    max_period: int = 16,
    nudge: float = 1e-7,
    progress: Callable[[SweepRow], None] | None = None,
    **parameters: float,
) -> list[SweepRow]:
    """Simulate at each value in turn, each time from the state where the last one ended.

    Parameters
    ----------
    model : Model
        The machine.
    over : str
        Name of the swept parameter.
    values : iterable of float
        Its values, in order; the last above the first means ``up``.
    start : mapping or ndarray, optional
        Start at the first value.
    transient, max_period
        As for `find_attractor`, at every value.
    nudge : float
        The velocity is changed by this at each value, as noise would: a motion that has become unstable is then
        left. 0 for none.
    progress : callable, optional
        Called with each row.
    **parameters
        Other parameters by name.

    Returns
    -------
    list of SweepRow

    Raises
    ------
    SimulationError
        If the parameter or the values cannot be.
    """
    numbers = [float(value) for value in values]
    if over not in model.amount_names:
        raise SimulationError(no_parameter(repr(over), f"the model {model.name!r}", model.amount_names))
    if not numbers:
        raise SimulationError(f"no values of {over} to sweep over: give at least one")
    vectors = [
        model.vector_at(over, value, parameters) for value in numbers
    ]  # all refused before work starts
    engine = machine(model.name)
    state = first_state(model, engine, vectors[0], start)
    direction = "up" if numbers[-1] >= numbers[0] else "down"
    rows = []
    for value, params in zip(numbers, vectors):
        if nudge and state[MODE] != 0.0:
            state[RATE] += nudge * np.sign(state[MODE])
        engine.launch(state, params)
        found = settle(model, engine, params, state, transient, max_period, patience=PATIENCE)
        row = _row(value, direction, found)
        rows.append(row)
        if progress is not None:
            progress(row)
    return rows


def _row(value: float, direction: str, found: Attractor) -> SweepRow:
    found, numbers = described(found)
    return SweepRow(
        value=value,
        direction=direction,
        attractor=found.kind,
        word=found.text,
        periods=found.periods,
        impacts=found.impacts,
        measures=numbers,
        detail=found,
    )


def described(found: Attractor) -> tuple[Attractor, dict[str, float]]:
    """The attractor with its kind and impacts as it is observed, and its measures by name (see `measure_names`)."""
    seen = observe(found)
    return lasting(found, seen), _named(found, seen)


def _named(found: Attractor, seen: Observation) -> dict[str, float]:
    model, params = found.model, found.params
    known = {
        "max_abs_q1": seen.max_abs_q1,
        "max_abs_w": seen.max_abs_w,
        "impact_speed": seen.impact_speed,
        "impacts_per_period": seen.impacts_per_period,
    }
    if "C2" in measure_names(model):
        known["C2"] = float(params[model.parameter_names.index("amplitude")]) ** 2
    return gauged(model, params, {name: known[name] for name in measure_names(model)})


def follow(found: Attractor, periods: float | None = None) -> Trajectory:
    """The motion on an attractor from its `state`: over one cycle, or sixteen periods where nothing recurs."""
    engine = found.machine
    begin = found.state.copy()
    state = begin.copy()
    length = periods if periods is not None else found.periods or (1 if found.kind == "stuck" else 16)
    until = state[4] + state[0] / (2.0 * np.pi) + length
    codes, modes, rows, status = collect(engine, state, found.params, until, 100_000)
    return Trajectory(found.model, found.params, engine, begin, state, codes, modes, rows, status)


def find_attractors(
    model: Any,
    starts: Sequence[Mapping[str, float] | np.ndarray | None],
    *,
    workers: int = 1,
    **options: Any,
) -> list[Attractor]:
    """`find_attractor` from many starts; the result does not depend on the number of worker processes."""
    return _many(partial(_one_attractor, model, options), starts, workers)


def different_attractors(model: Any, count: int, seed: int = 0, **options: Any) -> list[Attractor]:
    """The different attractors that `count` random starts lead to, in the order in which they are met; mirror images are one.

    Parameters
    ----------
    model : Model
    count, seed : int
        Starts, and the seed of their generator.
    **options
        As for `find_attractor`, parameters of the machine included.
    """
    generator = np.random.default_rng(seed)
    params = model.vector({k: v for k, v in options.items() if k in model.parameter_names})
    found: list[Attractor] = []
    for _ in range(count):
        one = find_attractor(model, model.random_start(params, generator), **options)
        if not any(one.distance(known) < SAME for known in found):
            found.append(one)
    return found


def sweeps(
    model: Any, over: str, runs: Sequence[Sequence[float]], *, workers: int = 1, **options: Any
) -> list[list[SweepRow]]:
    """`sweep` over several lists of values, such as one up and one down, in worker processes if asked for."""
    return _many(partial(_one_sweep, model, over, options), runs, workers)


def _one_attractor(model: Any, options: dict[str, Any], start: Any) -> Attractor:
    return find_attractor(model, start, **options)


def _one_sweep(model: Any, over: str, options: dict[str, Any], values: Sequence[float]) -> list[SweepRow]:
    return sweep(model, over, values, **options)


def _many(work: Callable[[Any], Any], jobs: Sequence[Any], workers: int) -> list[Any]:
    if workers < 1:
        raise SimulationError(f"workers = {workers}: give a number of processes, 1 or above")
    if workers == 1 or len(jobs) < 2:
        return [work(job) for job in jobs]
    size = max(1, len(jobs) // (4 * workers))
    pieces = [(work, jobs[i : i + size]) for i in range(0, len(jobs), size)]
    found = dict(spread(_of_each, pieces, min(workers, len(pieces)), _lost))
    return [result for place in range(len(pieces)) for result in found[place]]


def _of_each(work: Callable[[Any], Any], jobs: Sequence[Any]) -> list[Any]:
    return [work(job) for job in jobs]


def _lost(place: int) -> Any:
    raise SimulationError(
        f"workers: the process that simulated was lost {ATTEMPTS} times: there may be too little memory for several, or a script that calls "
        "for them has no `if __name__ == '__main__':` before the call"
    )
