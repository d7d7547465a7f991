"""How far the simulated motion leaves a claimed orbit: by events where they are distinct, by positions at a border.

At a border two events coincide or one has no strength, so the event list of the simulation is a matter of rounding there;
the motion itself is not.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from orbits.cycles import following_cavity, following_page
from orbits.cycles.cycle import Cycle

AT_BORDER = 1e-4  # margins below this may make two events one
WILD = 1e3  # multipliers above this blow rounding up within a period
AGREED = 1e-9  # deviations below this need no second look
FOLLOWED = {"native": following_cavity, "page": following_page}


def deviation(orbit: Cycle, known: Callable[[], tuple[np.ndarray, np.ndarray]]) -> float:
    """Largest deviation of the simulation over one period of an orbit; `known` tells its margins and multipliers, if that matters.

    Nodes are compared, event by event. At a border, where rounding alone makes events appear or vanish, and on very
    unstable orbits positions are compared at many instants as well, stretch by stretch, and the smaller
    deviation counts. Where rounding grows within a period until the events differ, though multipliers are small, each event is
    reached from the one before. Infinite if the simulation does something else. Lengths and speeds count in units of the machine's own size.
    """
    simulation = FOLLOWED[orbit.model.flow]
    error = simulation.by_events(orbit)
    if error < AGREED or (not len(orbit.word) and math.isfinite(error)):
        return error
    if not math.isfinite(error):
        margins, multipliers = known()
        if not (np.any(np.abs(margins) < AT_BORDER) or np.any(np.abs(multipliers) > WILD)):
            return simulation.one_by_one(orbit)
    return min(error, simulation.by_positions(orbit))
