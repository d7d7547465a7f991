"""Attractors by simulation: recognised by recurrence, at one parameter value or along a sweep."""

from typing import TYPE_CHECKING

from contvines.shared.on_demand import on_demand

if TYPE_CHECKING:
    from orbits.attractors.attractor import Attractor
    from orbits.attractors.search import different_attractors, find_attractor
    from orbits.attractors.sweeping import SweepRow, find_attractors, sweep, sweeps

__all__ = [
    "Attractor",
    "SweepRow",
    "different_attractors",
    "find_attractor",
    "find_attractors",
    "sweep",
    "sweeps",
]

__getattr__ = on_demand(
    __name__,
    {
        "Attractor": "orbits.attractors.attractor",
        "different_attractors": "orbits.attractors.search",
        "find_attractor": "orbits.attractors.search",
        **dict.fromkeys(("SweepRow", "find_attractors", "sweep", "sweeps"), "orbits.attractors.sweeping"),
    },
)
