"""What a motion settles on: recognised by recurrence, at one value or along a sweep.

The function `sweep` hides the module of the same name; ``from orbits.attractors.sweep import ...`` reaches into it.
"""

from typing import TYPE_CHECKING, Any

from orbits.attractors.attractor import Attractor
from orbits.attractors.search import different_attractors, find_attractor
from orbits.attractors.sweep import SweepRow, find_attractors, sweep, sweeps

if TYPE_CHECKING:
    from orbits.attractors.page import PageAttractor

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


def __getattr__(name: str) -> Any:
    if name == "PageAttractor":  # with the machines on a page
        from orbits.attractors.page import PageAttractor

        return PageAttractor
    raise AttributeError(f"orbits.attractors has no {name!r}")
