"""Event-driven simulation: exact event lists, trajectories, return maps, replay of orbits.

Every machine brings its own compiled stepper; the contract that they share is written down in
:mod:`orbits.machines.stepping`. Everything else here knows no machine.
"""

from typing import TYPE_CHECKING

from contvines.shared.on_demand import on_demand

if TYPE_CHECKING:
    from orbits.flows.native.trajectory import Balance, Samples
    from orbits.flows.protocol import SimulationError
    from orbits.flows.trajectory import Trajectory
    from orbits.simulation.replaying import Replay, replay
    from orbits.simulation.runs import simulate

__all__ = [
    "Balance",
    "Replay",
    "Samples",
    "SimulationError",
    "Trajectory",
    "replay",
    "simulate",
]

__getattr__ = on_demand(
    __name__,
    {
        "SimulationError": "orbits.flows.protocol",
        "simulate": "orbits.simulation.runs",
        **dict.fromkeys(("Replay", "replay"), "orbits.simulation.replaying"),
        "Trajectory": "orbits.flows.trajectory",
        **dict.fromkeys(("Balance", "Samples"), "orbits.flows.native.trajectory"),
    },
)
