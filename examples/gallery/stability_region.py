"""Stable parts of the orbits with two impacts per period, and how far the maps can be trusted.

Paper: figure for r = 0.76, mu = 0.5, g = 0.211: stable branches between a fold, a symmetry breaking at
C_max and a period doubling at C_PD.

Confirms: fold at C^2 = 0.0637942 and symmetry breaking at 0.5282903, in closed form and by multipliers of
the maps. Contradicts: the period doubling. The bare maps have a multiplier -1 at C^2 = 0.8679, but there
the relative velocity has already changed sign in the longer flight (least s w' = -0.110), and the
friction with it, which the maps ignore. The real branch ends at a border near C^2 = 0.732, where the
flight's velocity touches zero.
"""

import numpy as np
import paper
import two_impacts

from orbits import Absorber


def main():
    machine = Absorber(**paper.STRONG)
    fold, breaking = two_impacts.limits(machine)
    squares = fold + (1.0 - fold) * np.linspace(0.0, 1.0, 160) ** 2 + 1e-12
    right = two_impacts.speeds(two_impacts.symmetric(machine, squares, True))
    left = two_impacts.speeds(two_impacts.symmetric(machine, squares, False))
    branch = two_impacts.asymmetric(machine, 1.0)
    bent = two_impacts.speeds(branch)
    border = two_impacts.at(branch, lambda o: o.margin)
    doubling = two_impacts.at(branch, lambda o: float(np.min(o.multipliers.real)), -1.0)

    figure = paper.figure(7.4, 5.2)
    axes = figure.add_subplot()
    axes.plot(left["mean"][:, 0], left["C2"], color="k", ls=paper.DASHED, lw=1.2, label="unstable")
    stable = right["stable"]
    axes.plot(np.where(stable, right["mean"][:, 0], np.nan), right["C2"], color=paper.GREEN, label="stable")
    axes.plot(np.where(stable, np.nan, right["mean"][:, 0]), right["C2"], color="k", ls=paper.DASHED, lw=1.2)
    for k in (0, 1):
        line = bent["mean"][:, k]
        axes.plot(np.where(bent["real"], line, np.nan), bent["C2"], color=paper.GREEN)
        shown = "only in the maps" if k == 0 else None
        axes.plot(
            np.where(bent["real"], np.nan, line), bent["C2"], color=paper.GREY, ls=paper.DOTTED, label=shown
        )
    for orbit, marker, name in (
        (border, "v", "border: velocity touches 0"),
        (doubling, "^", "multiplier −1 of the maps"),
    ):
        speed = two_impacts.speeds([orbit])
        axes.plot(speed["mean"][0], np.repeat(speed["C2"], 2), marker, color=paper.RED, label=name)
    start = two_impacts.speeds(two_impacts.symmetric(machine, np.array([fold + 1e-12, breaking])))
    axes.plot(start["mean"][0, 0], fold, "s", color=paper.BLUE, label="fold")
    axes.plot(start["mean"][1, 0], breaking, "D", color=paper.BLUE, label="symmetry breaking")
    paper.legend(axes, loc="upper center")
    axes.set(xlabel="mean speed $B$", ylabel="$C^2$", ylim=(0, 1.0), xlim=(0, 1.45))

    both = two_impacts.symmetric(machine, np.array([fold + 1e-9, breaking]))
    return figure, {
        "fold, C^2": fold,
        "largest multiplier there": float(np.max(np.abs(both[0].multipliers))),
        "symmetry breaking, C^2": breaking,
        "largest multiplier there (2)": float(np.max(np.abs(both[1].multipliers))),
        "multiplier -1 of the half map there": float(np.min(both[1].half_multipliers.real)),
        "border of the real branch, C^2": float(border.params[0] ** 2),
        "multiplier -1 of the bare maps, C^2": float(doubling.params[0] ** 2),
        "least s w' of that orbit (negative: not a motion)": float(doubling.margin),
    }


if __name__ == "__main__":
    paper.run("stability_region", main)
