"""A stick-slip motion of the absorber far below resonance.

Paper: figure with G = 2.47, sigma = -9.04 (f = 7.25 Hz), r = 0.76, mu = 0.5, g = 0.211. Damping (not
printed): lambda = 0.9.

Confirms: the machine sticks, slips one way, sticks, slips the other way, without impacts. Refines: this
is so for every amplitude between mu g/Omega^2 (stuck for good) and h sqrt(1 + 4/pi^2) (no sticking at all).
"""

import numpy as np
import paper

from orbits import multiple_scales as ms
from orbits.attractors import find_attractor


def main():
    machine = paper.coupled(2.47, detuning=-9.04)
    found = find_attractor(machine, transient=1500)
    figure, (panels,) = paper.panels(9.2, 3.8, 1, 2)
    paper.portrait(panels, machine, found.state, 3)
    paper.legend(panels[0], loc="upper right", ncols=2)
    reach = 1.3 * float(np.max(np.abs(found.nodes[:, 1])))
    panels[0].set(ylim=(-0.2, 0.25))
    panels[1].set(xlim=(reach, -reach), xticks=(0.01, 0.0, -0.01))
    level = float(ms.friction_level(0.5, 0.211))
    c = float(np.hypot(found.nodes[0, 2], found.nodes[0, 3] / machine.frequency))
    return figure, {
        "word": found.text,
        "frequency in Hz": paper.NATURAL_FREQUENCY * machine.frequency,
        "amplitude C": c,
        "stuck for good below": (1 + paper.MASS_RATIO) * 0.5 * 0.211 / machine.frequency**2,
        "no sticking above": float(ms.sliding_bounds(level)[0]),
        "stroke of the absorber, max |w| - min |w|": float(np.ptp(found.nodes[:, 1])),
        "max |q1| in mm": 1e3 * paper.HALF_WIDTH * paper.peak(found),
    }


if __name__ == "__main__":
    paper.run("stick_slip", main)
