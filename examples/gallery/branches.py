"""Symmetric and asymmetric orbits with two impacts per period in the (B, C^2) plane; a free motion on top.

Paper: two figures for r = 0.76, mu = 0.1, g = 0.422: branches for the speeds after, before and between
impacts, and the projection of a free motion on the symmetric ones. Damping of the free motion (not
printed): lambda = 0.9.

Confirms: the three parabolas have their minima at the same C^2_min = 0.0233851, and B_min +- h~; the
asymmetric branches leave all three at C^2_max = 0.4961028; a free motion follows all three. Contradicts a
sign: with B- = v' - w'- as the paper defines it, B- and B+ of an impact have opposite signs, so the mean
is (B+ - B-)/2; what it calls B- is the magnitude. Refines: the asymmetric branch is drawn further than it
exists, see stability_region.py.
"""

import numpy as np
import paper
import two_impacts

from orbits import Absorber
from orbits.simulation import simulate

COLORS = {"mean": "k", "after": paper.RED, "before": paper.BLUE}
MARKS = {"mean": "", "after": "^", "before": "v"}
NAMES = {"mean": "mean $B$", "after": "after, $B^+$", "before": "before, $B^-$"}


def main():
    machine = Absorber(**paper.WEAK)
    fold, breaking = two_impacts.limits(machine)
    rise = np.linspace(0.0, 1.0, 160) ** 2
    squares = fold + (0.9 - fold) * rise + 1e-12
    right, left = (two_impacts.speeds(two_impacts.symmetric(machine, squares, s)) for s in (True, False))
    bent = two_impacts.speeds(two_impacts.asymmetric(machine, 0.9))
    free = paper.coupled(0.0, detuning=0.0, **paper.WEAK)
    run = simulate(free, paper.on_manifold(free, 0.69), periods=70)
    slow = paper.slow_variables(run)
    engaged = slow["C2"] > 1.1 * fold
    slow = {name: values[engaged] for name, values in slow.items()}

    figure, ((one, two),) = paper.panels(9.6, 4.4, 1, 2, sharey=True)
    for axes in (one, two):
        for name, color in COLORS.items():
            look = {"color": color, "marker": MARKS[name], "markevery": 24, "ms": 4}
            axes.plot(right[name][:, 0], right["C2"], label=NAMES[name], **look)
            axes.plot(left[name][:, 0], left["C2"], ls=paper.DASHED, lw=1, **look)
    for name, color in COLORS.items():
        for k in (0, 1):
            line = bent[name][:, k]
            one.plot(np.where(bent["real"], line, np.nan), bent["C2"], color=color, lw=1.2)
            one.plot(np.where(bent["real"], np.nan, line), bent["C2"], color=color, lw=1.2, ls=paper.DOTTED)
        two.plot(slow["B" if name == "mean" else name], slow["C2"], ".", color=color, ms=4)
    for level in (fold, breaking):
        one.axhline(level, color=paper.GREY, lw=0.8, ls=paper.DASHED)
    paper.legend(two, loc="lower right")
    one.set(xlabel="speed of the absorber", ylabel="$C^2$", ylim=(0, 0.9), xlim=(0, 1.7))
    two.set(
        xlabel="speed of the absorber",
        xlim=(0, 1.7),
        ylabel="" if not paper.narrow() else "$C^2$",
        title="dots: free motion, coupled machine",
    )
    one.set(title="dashed: unstable; dotted: beyond a border")

    lowest = {name: float(right[name][0, 0]) for name in COLORS}
    level = float(two_impacts.friction_number(0.1, 0.422, paper.MASS_RATIO))
    orbit = machine.symmetric_orbit(0.5)
    curve = np.interp(slow["B"], right["mean"][:, 0], right["C2"])
    return figure, {
        "C^2_min": fold,
        "C^2_max": breaking,
        "B_min between, after, before": tuple(round(v, 6) for v in lowest.values()),
        "B_min +- h~": (round(lowest["mean"] + level, 6), round(lowest["mean"] - level, 6)),
        "C^2 where the asymmetric branch begins": float(bent["C2"][0]),
        "asymmetric branch is real up to C^2": float(bent["C2"][bent["real"]].max()),
        "B+ and B- = v' - w'- of one impact (signs)": (
            round(float(orbit.events.B_post[0]), 4), round(float(orbit.events.B_pre[0]), 4)),
        "free motion: largest distance from the mean curve in C^2": float(np.max(np.abs(curve - slow["C2"]))),
    }  # fmt: skip


if __name__ == "__main__":
    paper.run("branches", main)
