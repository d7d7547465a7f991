"""First cycle of a continuation: Newton's method from states at given times to the cycle near them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ..problems.scales import given_scale
from . import mesh
from .cycles import CycleProblem
from .kernels import settled
from .orbit import CycleOrbit
from .simulation import SAMPLES, Stopped

if TYPE_CHECKING:
    from ..problems.functions import ParameterSet
    from .field import Field
    from .flow import Flow

INTERVALS = 40  # mesh intervals of a cycle from data ...
MORE = 1, 4, 16  # ... and their multiples that are tried in turn: bursts of sharp spikes need more
HALVES = 2  # equal parts of the mesh: a state and its image half a period later are then known with the same accuracy
MOST_TURNS = 64  # most repetitions of a shorter cycle in a motion
# largest distance of equal cycles on different meshes, in units of the error between mesh points
MESHES = 10.0


def cycle_beside(
    flow: Flow, times: np.ndarray, states: np.ndarray, parameters: ParameterSet, rounds: int
) -> CycleOrbit:
    """Solve for the cycle near states (n, d) at times (n,), which cover one period (of forced flows: `rounds` periods of the forcing).

    Raises
    ------
    ValueError
        If Newton's method fails, or converges to an equilibrium or to a cycle that crosses an event.
    """
    field, s, p = flow.field.against(parameters), flow.settings, parameters.start
    ranges = np.ptp(states, axis=0)
    scale = given_scale(flow.given_scale, len(flow.x0))
    if scale is None:
        moves = (ranges > s.still * field.lengths).any()
        scale = np.maximum(ranges, s.smallest * ranges.max()) if moves else field.lengths
    sizes = scale, float(times[-1] - times[0]), abs(p) or 1.0

    def problems() -> Iterator[CycleProblem]:
        for more in MORE:
            n = more * INTERVALS * (rounds if field.forced else 1)
            for widths in (np.full(n, 1.0 / n), mesh.along_data(times, states / scale, n, HALVES)):
                guess = _guess(flow.degree, field, p, times, states, widths, rounds)
                yield flow.cycles(field, guess, (n, rounds, HALVES), sizes)  # type: ignore[misc]

    found = next(filter(None, (settled(problem, problem.u0, p) for problem in problems())), None)
    if found is None:
        raise ValueError(
            "Newton's method does not converge from these states; give a longer transient= (of attractor), or times and states nearer to one period of a cycle"
        )
    cycles, u = found
    # a constant solution of a forced flow is a cycle with the period of the forcing
    if not field.forced and (np.ptp(cycles.curve(u)[0], axis=(0, 1)) / scale).max() < s.same:
        raise ValueError("Newton's method leads from these states to an equilibrium, not to a cycle")
    name = cycles.crossed(u, p)
    if name is not None:
        raise Stopped(f"the cycle crosses the event {name}, which stops the motion")
    shorter = cycles.root(u, p)
    if shorter is not None and isinstance(shorter[0], CycleProblem):
        cycles, u = shorter[0], shorter[1]
    orbit = CycleOrbit(cycles, u, p)
    return _shortest_period(flow, orbit, parameters, cycles.rounds) or orbit


def _guess(
    degree: int,
    field: Field,
    p: float,
    times: np.ndarray,
    states: np.ndarray,
    widths: np.ndarray,
    rounds: int,
) -> np.ndarray:
    """Unknowns of a cycle, interpolated from states at times."""
    places = mesh.node_places(mesh.rule(degree), widths)
    period_entry = [] if field.forced else [times[-1] - times[0]]
    if field.forced:
        period = rounds * float(field.length_of_period(p))
        places = places * period
        places = np.where(places < times[0], places + period, places)
    else:
        places = times[0] + places * (times[-1] - times[0])
    x = np.column_stack([np.interp(places, times, column) for column in states.T])
    return np.concatenate([x.reshape(-1), period_entry, widths])


def _shortest_period(
    flow: Flow, orbit: CycleOrbit, parameters: ParameterSet, rounds: int
) -> CycleOrbit | None:
    """The shorter cycle that an orbit repeats several times; None if there is none.

    A motion that spirals towards a cycle may be found to recur after several periods before it is found to recur after one.
    """
    lengths, forced, s = flow.field.lengths, flow.field.forced, flow.settings
    extent = np.ptp(orbit.states, axis=0) / lengths
    size = lengths * np.maximum(extent, s.least * extent.max())
    near, exact = (size * share + s.still * lengths for share in (s.recurs, MESHES * flow.error))
    times = np.linspace(0.0, orbit.period, SAMPLES + 1)
    states, parts = orbit(times), np.arange(rounds if forced else MOST_TURNS, 1, -1)
    for n in parts[(np.abs(orbit(orbit.period / parts) - states[0]) <= near).all(axis=1)].tolist():
        if forced and rounds % n:
            continue
        if not (np.abs(orbit((times + orbit.period / n) % orbit.period) - states) <= near).all():
            continue
        share, left = times / n, rounds // n if forced else 1
        try:
            shorter = cycle_beside(flow, share, orbit(share), parameters, left)
        except ValueError:
            continue
        repeated = shorter(n * shorter.period * times / orbit.period % shorter.period)
        if (np.abs(repeated - states) <= exact).all():
            return shorter
    return None
