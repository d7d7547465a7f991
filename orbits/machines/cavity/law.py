"""What the equations of a shaken cavity need of a machine's numbers (compiled).

    w'' = -C Omega^2 sin Psi - b - s a_s,      right <= w <= left,      w'+ = -r w'- at either wall,

with s the sign of w' and a_s the friction's acceleration while sliding to the left wall (s = +1) or to the right one (s = -1).
"""

from __future__ import annotations

from typing import NamedTuple


class Law(NamedTuple):
    """The numbers of the equations of motion, or their derivatives with respect to the parameter that varies.

    amplitude C and frequency Omega; pull_left and pull_right the accelerations w'' of friction and slope together, -w'' while
    sliding to either wall without shaking: b + a_left and b - a_right; slope b; restitution and place of either wall.
    """

    amplitude: float
    omega: float
    pull_left: float
    pull_right: float
    slope: float
    restitution_left: float
    restitution_right: float
    left: float
    right: float
