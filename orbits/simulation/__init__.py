"""Event-driven simulation: exact event lists, attractors, replay of orbits, sweeps.

Every model brings its own compiled stepper (``absorber_kernels``, ``coupled_kernels``); the contract that
they share is written down in :mod:`orbits.simulation.contract`. Everything else here is model-agnostic.

Importing this package is cheap: compiled code is loaded by the first simulation. The functions `replay` and `sweep`
hide the modules of the same names; ``from orbits.simulation.sweep import ...`` reaches into those.
"""

from orbits.simulation.attractor import Attractor
from orbits.simulation.driver import SimulationError, simulate
from orbits.simulation.recurrence import find_attractor
from orbits.simulation.replay import Replay, replay, replay_nodes
from orbits.simulation.sweep import SweepRow, find_attractors, sweep, sweeps
from orbits.simulation.trajectory import Balance, Samples, Trajectory

__all__ = [
    "Attractor",
    "Balance",
    "Replay",
    "Samples",
    "SimulationError",
    "SweepRow",
    "Trajectory",
    "find_attractor",
    "find_attractors",
    "replay",
    "replay_nodes",
    "simulate",
    "sweep",
    "sweeps",
]
