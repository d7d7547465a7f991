"""Where the mean position of an impact-free motion is pinned.

Such a motion may be moved as a whole. One displacement equation of its cycle follows from the others; the pin w_i + w_{i+1} = left + right
takes the place of that of the last flight, whose ends lie on both sides of the middle between the walls. A stick has both its ends in one place.
"""

from __future__ import annotations


def last_flight(modes):
    """The last event that is followed by a flight."""
    last = modes.size - 1
    return last if modes[last] != 0 else last - 1
