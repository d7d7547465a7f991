"""What a motion settles on: recognised by recurrence, at one value or along a sweep.

The function `sweep` hides the module of the same name; ``from orbits.attractors.sweep import ...`` reaches into it.
"""

from orbits.attractors.attractor import Attractor
from orbits.attractors.page import PageAttractor
from orbits.attractors.search import different_attractors, find_attractor
from orbits.attractors.sweep import SweepRow, find_attractors, sweep, sweeps

__all__ = [
    "Attractor",
    "PageAttractor",
    "SweepRow",
    "different_attractors",
    "find_attractor",
    "find_attractors",
    "sweep",
    "sweeps",
]
