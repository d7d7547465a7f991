"""Parameter sweeps by simulation, each value begun at the last state of the value before; attractors of many starts in worker processes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.near_names import no_parameter
from contvines.shared.processes import ATTEMPTS, spread
from orbits.attractors.attractor import Attractor, described, modulated
from orbits.attractors.search import find_attractor, goes_on
from orbits.flows import flow_of, simulator_of
from orbits.flows.protocol import SimulationError
from orbits.settings import SIMULATING

if TYPE_CHECKING:
    from orbits.machines.varying import Varying


@dataclass(frozen=True)
class SweepRow:
    """The attractor at one value of a sweep.

    Attributes
    ----------
    value : float
        The swept parameter.
    direction : str
        ``up`` or ``down``.
    attractor : str
        Kind of the attractor; see `orbits.attractors.attractor.Attractor`.
    word : str
        Events of the cycle; empty if the motion is not periodic.
    periods, impacts : int
        Forcing periods k and impacts l of the cycle; 0 if the motion is not periodic.
    measures : dict
        Measures by name, the same names in every row; see `orbits.attractors.attractor.measure_names`.
    detail : Attractor
        The attractor itself, with its nodes and last state.
    modulation : str
        ``weak modulation``, ``strong modulation`` (impacts stop and begin again), or either after ``chaotic``; empty for periodic motions.
    """

    value: float
    direction: str
    attractor: str
    word: str
    periods: int
    impacts: int
    measures: Mapping[str, float]
    detail: Attractor = field(repr=False)
    modulation: str = ""

    @property
    def dots(self) -> list[float]:
        """Ordinates in a bifurcation picture: one measure of the whole motion, B or the approach speed of every impact, or the extremes of the first state."""
        names = flow_of(self.detail.model).swept(self.detail.model)
        return [float(self.measures[name]) for name in names if name in self.measures] or self.detail.dots


def sweep(
    model: Varying,
    over: str,
    values: Iterable[float],
    *,
    start: Mapping[str, float] | np.ndarray | None = None,
    transient: float = 200,
    max_period: int = 16,
    nudge: float = SIMULATING.nudge,
    exponents: bool = True,
    progress: Callable[[SweepRow], None] | None = None,
    **parameters: float,
) -> list[SweepRow]:
    """Simulate at each value in turn, each time from the state where the last one ended.

    Parameters
    ----------
    model : Model or Machine
    over : str
        Name of the swept parameter.
    values : iterable of float
        Its values, in order; the last above the first means ``up``.
    start : mapping or ndarray, optional
        Start at the first value.
    transient, max_period
        As for `Varying.attractor`, at every value.
    nudge : float
        Perturbation of a velocity at each value, so that the motion leaves a cycle that has become unstable; 0 for none.
    exponents : bool
        Compute Lyapunov exponents of motions that are not periodic, for `SweepRow.modulation`. For a declared machine this takes as long as ten
        simulations.
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
        If the machine has no such parameter, a value is not allowed, or there are no values.
    """
    numbers = [float(value) for value in values]
    if over not in model.amount_names:
        raise SimulationError(no_parameter(repr(over), f"the model {model.name!r}", model.amount_names))
    if not numbers:
        raise SimulationError(f"no values of {over} to sweep over: give at least one")
    vectors = [
        model.vector_at(over, value, parameters) for value in numbers
    ]  # bad values are refused before the first simulation
    state = simulator_of(model, vectors[0]).state_of(start)
    direction = "up" if numbers[-1] >= numbers[0] else "down"
    rows = []
    for value, params in zip(numbers, vectors):
        simulator = simulator_of(model, params)
        simulator.go_on(state, nudge)
        found, measures = described(goes_on(simulator, transient, max_period, None))
        text = modulated(found, measures) if exponents else ""
        row = SweepRow(
            value, direction, found.kind, found.text, found.periods, found.impacts, measures, found, text
        )
        state = found.state
        rows.append(row)
        if progress is not None:
            progress(row)
    return rows


def find_attractors(
    model: Varying,
    starts: Sequence[Mapping[str, float] | np.ndarray | None],
    *,
    workers: int = 1,
    **options: Any,
) -> list[Attractor]:
    """Call `find_attractor` for many starts; the result does not depend on the number of worker processes."""
    return _many(partial(find_attractor, model, **options), starts, workers)


def sweeps(
    model: Varying, over: str, runs: Sequence[Sequence[float]], *, workers: int = 1, **options: Any
) -> list[list[SweepRow]]:
    """Call `sweep` for several lists of values, such as one up and one down, in `workers` processes."""
    return _many(partial(sweep, model, over, **options), runs, workers)


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


def _lost(place: int):
    raise SimulationError(
        f"workers: the process that simulated was lost {ATTEMPTS} times: there may be too little memory for several, or a script that calls "
        "for them has no `if __name__ == '__main__':` before the call"
    )
