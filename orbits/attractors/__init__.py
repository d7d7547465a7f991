"""What a motion settles on: recognised by recurrence, at one value or along a sweep.

The function `sweep` hides the module of the same name; ``from orbits.attractors.sweep import ...`` reaches into it.
"""

from orbits.attractors.attractor import Attractor
from orbits.attractors.recurrence import find_attractor
from orbits.attractors.sweep import SweepRow, different_attractors, find_attractors, sweep, sweeps

__all__ = [
    "Attractor",
    "SweepRow",
    "different_attractors",
    "find_attractor",
    "find_attractors",
    "sweep",
    "sweeps",
]
