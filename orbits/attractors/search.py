"""What a machine settles on from one start or many."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from orbits.attractors import page
from orbits.attractors.observation import lasting
from orbits.attractors.recurrence import left_over, settle
from orbits.flows.page.stepper import Stepper
from orbits.flows.protocol import SimulationError
from orbits.simulation.page import PageSimulator

SAME = 1e-4  # difference of the nodes of one motion met twice
DRAWS = 200  # starts drawn at most to find one that can be simulated


def find_attractor(
    model: Any,
    start: Mapping[str, float] | np.ndarray | None = None,
    *,
    transient: float | None = None,
    max_period: int = 16,
    tolerance: float = 1e-6,
    patience: int | None = None,
    **parameters: float,
) -> Any:
    """Simulate, leave out the transient, and recognise what is left.

    Parameters
    ----------
    model : Model or Machine
    start : mapping or ndarray, optional
        As for `orbits.simulation.simulate`; by default the absorber starts from rest in the middle of the cavity, a page with all states zero.
    transient : float, optional
        Forcing periods left out first, 300 (of a self-excited machine events, 100).
    max_period : int
        Longest recurrence looked for, in forcing periods (events of a self-excited cycle: 25 times as many).
    tolerance : float
        Largest difference of two nodes of a built-in machine that may count as a return; the orbit is then polished.
    patience : int, optional
        How often the transient is prolonged, fourfold (page: twofold, four times), when nothing recurs; 2.
    **parameters
        Parameters that are no fields of the machine (`amplitude`), or that replace them.

    Returns
    -------
    Attractor or PageAttractor

    Raises
    ------
    SimulationError
        If the start or the lengths cannot be.
    """
    if max_period < 1:
        raise SimulationError(f"max_period = {max_period}: give a whole number, 1 or above")
    if transient is not None and not (np.isfinite(transient) and transient >= 0.0):
        raise SimulationError(f"transient = {transient}: give a number of forcing periods, 0 or above")
    if model.flow == "page":
        stepper = Stepper(model, model.vector(parameters))
        begin = page.begun(model, stepper.params, start)
        stepper.start(begin[1:], float(begin[0]))
        length = 100 if transient is None else int(transient)
        return page.attracted(stepper, length, max_period, 4 if patience is None else patience)
    length = 300.0 if transient is None else transient
    tries = 2 if patience is None else patience
    return lasting(left_over(model, start, length, max_period, tolerance, tries, **parameters))


def goes_on(simulator: Any, transient: int, max_period: int) -> Any:
    """The attractor of the motion on which a simulator is, which is moved on; it is looked for once, after the transient."""
    if isinstance(simulator, PageSimulator):
        return page.attracted(simulator.stepper, transient, max_period, 0)
    state = simulator.state
    return settle(
        simulator.model, simulator.engine, simulator.params, state, float(transient), max_period, 1e-6, 0
    )


def unobserved(model: Any, start: Any = None, **parameters: Any) -> Any:
    """`find_attractor`, a motion that does not recur not yet observed for long: for those who observe it themselves."""
    if model.flow == "page":
        return find_attractor(model, start, **parameters)
    return left_over(model, start, **parameters)


def different_attractors(
    model: Any, count: int, seed: int = 0, size: float = 1.0, **options: Any
) -> list[Any]:
    """The different attractors that `count` random starts lead to, in the order in which they are met; mirror images are one.

    Parameters
    ----------
    model : Model or Machine
    count, seed : int
        Starts, and the seed of their generator.
    size : float
        Of a page: states are drawn within +-`size`.
    **options
        As for `find_attractor`, parameters of the machine included.

    Raises
    ------
    SimulationError
        If no start can be simulated.
    """
    generator = np.random.default_rng(seed)
    params = model.vector({k: v for k, v in options.items() if k in model.parameter_names})
    found: list[Any] = []
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
        if not any(one.distance(known) < SAME for known in found):
            found.append(one)
    return found
