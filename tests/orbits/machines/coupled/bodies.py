"""Orbits of the coupled machine in the coordinates of its bodies."""

import numpy as np


def nodes_of_bodies(orbit):
    """Phase, q1, q2, q1', q2' just after its events."""
    relative = np.array([orbit.events.w, orbit.events.rate_post])
    q1, q2 = orbit.model.bodies(relative, orbit.nodes[:, 2:].T, orbit.params)
    return np.column_stack([orbit.nodes[:, 0], q1[0], q2[0], q1[1], q2[1]])
