"""An inclined cavity: what becomes of the symmetry breaking when the absorber's track is not level.

No figure of the paper, whose cavity is level. Refines: on a slope the two walls are unlike from the start, so nothing is left to
break. Of the pitchfork one side joins the orbits of small amplitude, the other begins at a fold of its own. That fold moves away from the level
cavity's symmetry breaking like the slope to the power 2/3, as it must for an imperfection of first order.
"""

import math

import numpy as np
import paper

import contvines as cv
from orbits import Cavity

SLOPES = (0.005, 0.01, 0.02)
LEAST, LARGEST = 0.25, 0.85


def machine(slope: float) -> Cavity:
    return Cavity(**paper.STRONG, slope=slope)


def left_speed(orbit) -> float:
    """Mean of the absorber's speeds after and before its impact on the left wall."""
    place = orbit.word.events.index("L")
    return 0.5 * float(orbit.events.B_post[place] - orbit.events.B_pre[place])


def curves(orbit, parameter: str = "amplitude"):
    """The branches of an orbit's diagram: amplitudes, speeds at the left wall and stability, and the special points."""
    graph = cv.diagram(orbit, over=parameter, within=(LEAST, LARGEST), depth=1)
    drawn = []
    for branch in graph.branches.values():
        orbits = [branch.orbit(i) for i in range(len(branch))]
        if any("".join(sorted(o.word.events)) != "LR" for o in orbits[:1]):
            continue
        drawn.append(
            (
                np.array(branch.values),
                np.array([left_speed(o) for o in orbits]),
                np.array([o.stable for o in orbits]),
            )
        )
    return drawn, graph


def detached(slope: float):
    """The orbit of the other side at amplitude 0.8, from the level cavity's asymmetric orbits."""
    level = cv.diagram(machine(0.0).orbit("LR", amplitude=0.7), over="amplitude", within=(0.6, 0.85), depth=1)
    branch = next(b for b in level.branches.values() if not b.orbit(len(b) // 2).symmetric)
    place = int(np.argmin(np.abs(np.array(branch.values) - 0.8)))
    bent = branch.orbit(place)
    pair = [bent, bent.mirror()]
    return [
        machine(slope).orbit(o.word, 1, guess=o.nodes, amplitude=o.parameters["amplitude"]) for o in pair
    ], level


def main():
    figure = paper.figure(7.2, 4.8)
    axes = figure.subplots()
    near = axes.inset_axes((0.48, 0.34, 0.5, 0.33))  # where the pitchfork comes apart
    near.set(xlim=(0.67, 0.82), ylim=(0.99, 1.2))
    near.tick_params(labelsize="small")
    near.locator_params(nbins=4)
    straight, level = curves(machine(0.0).orbit("LR", amplitude=0.55))
    for k, (amplitude, speed, _) in enumerate(straight):
        for place in (axes, near):
            name = "level" if k == 0 else None
            place.plot(amplitude, speed, color=paper.GREY, lw=0.9, ls=paper.DOTTED, label=name)
    breaking = next(s.value for s in level.special.values() if s.kind == "symmetry-breaking")
    folds = []
    for slope in SLOPES:
        found, _ = detached(slope)
        nearest = []
        for orbit in found:
            drawn, graph = curves(orbit)
            nearest += [s.value for s in graph.special.values() if s.kind == "fold" and s.value > 0.5]
            assert not [s for s in graph.special.values() if s.kind == "symmetry-breaking"]
            if slope != SLOPES[-1]:
                continue
            for amplitude, speed, stable in drawn:
                for part, style in ((stable, "-"), (~stable, paper.DASHED)):
                    for place in (axes, near):
                        place.plot(amplitude, np.where(part, speed, np.nan), color=paper.BLUE, ls=style)
        folds.append(min(nearest))
    axes.plot([], [], color=paper.BLUE, label=f"slope {SLOPES[-1]:g}, stable")
    axes.plot([], [], color=paper.BLUE, ls=paper.DASHED, label="unstable")
    for value, color, name, side in (
        (breaking, paper.GREY, "symmetry\nbreaking", "right"),
        (folds[-1], paper.BLUE, "fold", "left"),
    ):
        near.axvline(value, color=color, lw=0.7)
        near.text(
            value + (0.002 if side == "left" else -0.002),
            1.19,
            name,
            color=color,
            ha=side,
            va="top",
            fontsize="small",
        )
    axes.indicate_inset_zoom(near, edgecolor="0.45")
    axes.set(xlabel="amplitude $C$", ylabel="mean speed $B$ at the left wall", xlim=(LEAST, LARGEST))
    paper.legend(axes, loc="upper left")
    gaps = np.array(folds) - breaking
    powers = np.log(gaps[1:] / gaps[:-1]) / math.log(2.0)
    return figure, {
        "symmetry breaking of the level cavity": breaking,
        "fold of the detached orbits, slope 0.005": folds[0],
        "slope 0.01": folds[1],
        "slope 0.02": folds[2],
        "power of the slope with which it moves": tuple(round(float(p), 3) for p in powers),
    }


if __name__ == "__main__":
    paper.run("inclined_cavity", main)
