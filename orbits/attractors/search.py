"""What a machine settles on from one start or many."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.attractors.attractor import Attractor
from orbits.attractors.observation import described, lasting
from orbits.attractors.recurrence import attracted
from orbits.flows.protocol import SimulationError, Simulator
from orbits.settings import SIMULATING
from orbits.simulation.runs import simulator_of

if TYPE_CHECKING:
    from orbits.machines.varying import Varying
    from orbits.orbit import Orbit


DRAWS = 200  # starts drawn at most to find one that can be simulated


def find_attractor(
    model: Varying,
    start: Mapping[str, float] | np.ndarray | None = None,
    *,
    transient: float | None = None,
    max_period: int = 16,
    tolerance: float | None = None,
    patience: int | None = None,
    observed: bool = True,
    **parameters: float,
) -> Attractor:
    """Simulate, leave out the transient, and recognise what is left: the work of `Varying.attractor`, which says what is given."""
    if max_period < 1:
        raise SimulationError(f"max_period = {max_period}: give a whole number, 1 or above")
    if transient is not None and not (np.isfinite(transient) and transient >= 0.0):
        raise SimulationError(f"transient = {transient}: give a number of forcing periods, 0 or above")
    simulator = simulator_of(model, model.vector(parameters))
    simulator.put(start)
    how = simulator.waiting
    length = how.transient if transient is None else transient
    tries = how.tries if patience is None else patience
    found = attracted(simulator, length, max_period, how.returned if tolerance is None else tolerance, tries)
    return lasting(found) if observed else found


def goes_on(simulator: Simulator, transient: float, max_period: int, patience: int | None = 0) -> Attractor:
    """The attractor of the motion on which a simulator is, which is moved on; None: as patient as a sweep."""
    how = simulator.waiting
    tries = how.in_sweeps if patience is None else patience
    return attracted(simulator, transient, max_period, how.returned, tries)


def beginning_with(orbit: Orbit, transient: float, max_period: int) -> dict[str, float]:
    """Measures of what the simulation settles on that begins with a motion; none of one without events."""
    if not len(orbit.nodes):
        return {}
    simulator = simulator_of(orbit.model, orbit.params)
    simulator.begin(orbit.word, orbit.nodes[0])
    return described(goes_on(simulator, transient, max_period))[1]


def different_attractors(
    model: Varying, count: int, seed: int = 0, size: float = 1.0, **options: Any
) -> list[Attractor]:
    """The attractors that random starts lead to: the work of `Varying.attractors`, which says what is given."""
    generator = np.random.default_rng(seed)
    params = model.vector({k: v for k, v in options.items() if k in model.parameter_names})
    found: list[Attractor] = []
    for _ in range(count):
        refused = SimulationError("")
        for _ in range(DRAWS):
            try:
                one = find_attractor(model, model.random_start(params, generator, size), **options)
                break
            except SimulationError as error:
                refused = error
        else:
            raise SimulationError(f"no start with states within {size:g} could be simulated: {refused}")
        if not any(one.distance(known) < SIMULATING.same for known in found):
            found.append(one)
    return found
