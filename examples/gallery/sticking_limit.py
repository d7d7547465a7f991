"""Linear response with the absorber stuck, and where friction can no longer hold it.

Paper: figure with the linear response at G = 2.47 and the limit q1_cr = mu g/omega^2. Damping (not
printed): lambda = 0.9; base amplitude E = G b eps = 0.296 mm.

Confirms: the limit is exact for the stuck machine (the simulator finds it stuck just inside and moving
just outside), and the stuck response hardly differs from that without absorber there. Refines: the lower
and upper end of the stuck range in hertz.
"""

import numpy as np
import paper
from scipy.optimize import brentq

from orbits.attractors import find_attractor
from orbits.design import Design


def main():
    machine = Design()
    base = float(machine.excitation(2.47))
    f = np.linspace(6.2, 9.2, 1500)
    alone, stuck = machine.linear_response(f, base), machine.linear_response(f, base, stuck=True)
    limit = machine.sticking_limit(f)
    held = machine.is_stuck(f, base)

    def excess(x):
        return machine.linear_response(x, base, stuck=True) - machine.sticking_limit(x)

    low, high = brentq(excess, 6.2, 7.6), brentq(excess, 7.7, 9.2)

    figure = paper.figure(7.4, 4.6)
    axes = figure.add_subplot()
    axes.plot(f, 1e3 * alone, color=paper.GREY, label="oscillator alone")
    axes.plot(f, 1e3 * limit, color=paper.BLUE, ls=paper.DOTTED, label=r"$q_{1,\mathrm{cr}}=\mu g/\omega^2$")
    axes.plot(f, np.where(held, 1e3 * stuck, np.nan), color="k", ls=paper.DASHED, label="absorber stuck")
    axes.plot(
        [low, high],
        [1e3 * machine.sticking_limit(x) for x in (low, high)],
        "o",
        color=paper.RED,
        label="it begins to move",
    )
    axes.set(xlabel="$f$ [Hz]", ylabel="$|q_1|_{\\max}$ [mm]", ylim=(0, 12))
    paper.legend(axes, loc="upper left")

    numbers = {
        "base amplitude E in mm": 1e3 * base,
        "stuck below, Hz": low,
        "stuck above, Hz": high,
        "q1_cr there, mm": (
            round(1e3 * float(machine.sticking_limit(low)), 4), round(1e3 * float(machine.sticking_limit(high)), 4)),
        "stuck response over the one without absorber, at the ends": tuple(
            round(float(machine.linear_response(x, base, stuck=True) / machine.linear_response(x, base)), 4)
            for x in (low, high)
        ),
    }  # fmt: skip
    gravity = machine.gravity
    for name, x in (("0.2 % inside", low * 0.998), ("0.2 % outside", low * 1.002)):
        coupled = paper.coupled(2.47, frequency=x / machine.natural_frequency, gravity=gravity)
        found = find_attractor(coupled, transient=3000)
        numbers[f"simulated, {name}"] = (found.kind, found.text)
    return figure, numbers


if __name__ == "__main__":
    paper.run("sticking_limit", main)
