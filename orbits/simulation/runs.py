"""A machine simulated from event to event."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

from orbits.flows.protocol import SimulationError, Simulator
from orbits.simulation.driver import MOST_EVENTS

if TYPE_CHECKING:
    from orbits.machines.varying import Varying


Start = Mapping[str, float] | np.ndarray | None
"""Where a simulation begins: entries by name, or a state in which another one has ended; None for rest."""

SIMULATORS = {
    "native": ("orbits.simulation.native", "NativeSimulator"),
    "page": ("orbits.simulation.page", "PageSimulator"),
}


def simulator_of(model: Varying, params: np.ndarray) -> Simulator:
    """The simulator of a machine at these parameters; the contract is at the top of `orbits.flows.protocol`."""
    return _simulators(model.flow)(model, params)


@cache
def _simulators(flow: str) -> type:
    """The simulator of a flow, imported when a machine asks for it."""
    module, name = SIMULATORS[flow]
    return getattr(import_module(module), name)


def simulate(
    model: Varying,
    start: Mapping[str, float] | np.ndarray | None = None,
    *,
    periods: float | None = None,
    time: float | None = None,
    events: int | None = None,
    **parameters: float,
):
    """Simulate a machine from event to event: the work of `Varying.simulate`, which says what is given and what comes of it."""
    params = model.vector(parameters)
    if periods is None and time is None and events is None:
        raise SimulationError("neither periods, time nor events are given: say how long to simulate")
    if periods is not None and not model.forced:
        raise SimulationError("periods: a self-excited machine has no forcing to count; give time or events")
    for name, value in (("periods", periods), ("time", time), ("events", events)):
        if value is not None and not (math.isfinite(value) and value >= 0.0):
            raise SimulationError(f"{name} = {value}: give a number, 0 or above")
    simulator = simulator_of(model, params)
    simulator.put(start)
    if periods is None and time is not None:
        periods = (
            time * float(model.phase_speed(params)) / float(model.gauge("time", params)) / (2.0 * math.pi)
        )
    return simulator.run(math.inf if periods is None else periods, MOST_EVENTS if events is None else events)
