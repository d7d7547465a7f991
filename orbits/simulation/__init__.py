"""Event-driven simulation: exact event lists, trajectories, return maps, replay of orbits.

Every machine brings its own compiled stepper; the contract that they share is written down in
:mod:`orbits.machines.stepping`. Everything else here knows no machine.

Importing this package is cheap: compiled code is loaded by the first simulation. The function `replay` hides the
module of the same name; ``from orbits.simulation.replay import ...`` reaches into it.
"""

from orbits.flows.protocol import SimulationError
from orbits.simulation.replay import Replay, replay, replay_nodes
from orbits.simulation.runs import simulate
from orbits.simulation.trajectory import Balance, Samples, Trajectory

__all__ = [
    "Balance",
    "Replay",
    "Samples",
    "SimulationError",
    "Trajectory",
    "replay",
    "replay_nodes",
    "simulate",
]
