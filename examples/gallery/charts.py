"""Charts of two parameters: amplitude x friction and amplitude x restitution.

No figure of the paper: it shows one parameter at a time. What a designer reads off: the fold (least shaking at which the absorber
hits its walls) climbs with friction and hardly cares for restitution; symmetry breaking (the end of the regular
motion) hardly cares for friction and falls as restitution grows. A wide range of work wants little friction and little restitution.

Confirms: both curves are the closed forms of the symmetric motion all along. Refines: the doubled motions end where a turn grazes a
wall, at points of codimension two that move with neither parameter alone.
"""

import numpy as np
import paper

import contvines as cv
from contvines.plots.chart import plot_chart
from orbits import Absorber

SPANS = {"friction": (0.05, 0.9), "restitution": (0.55, 0.95)}


def closed_form(kind: str, friction: float, restitution: float) -> float:
    """Amplitude of the fold or the symmetry breaking of the symmetric motion with two impacts."""
    R = (1 - restitution) / (1 + restitution)
    H = np.pi / 2 * (1 + paper.MASS_RATIO) * friction * paper.STRONG["gravity"]
    below = np.pi**2 + 4 * R**2 if kind == "fold" else np.pi**2 - 4
    beta = (2 * np.pi - 4 * R * H) / below
    return float(np.hypot(1 - np.pi * beta / 2, R * beta + H))


def main():
    machine = Absorber(**paper.STRONG)
    graph = cv.diagram(machine.symmetric_orbit(amplitude=0.55), over="amplitude", within=(0.2, 1.3))
    figure = paper.figure(7.4, 10.0)
    numbers = {}
    for axes, (over, within) in zip(figure.subplots(2, 1), SPANS.items()):
        chart = cv.chart(graph, over=over, within=within)
        # both panels show the same kinds: one key, under the last one
        plot_chart(chart, axes=axes, legend="below" if over == "restitution" else False)
        worst = 0.0
        for label, kind in (("LP1", "fold"), ("SB1", "symmetry-breaking")):
            for p, q in chart[label].values:
                given = {"friction": 0.5, "restitution": 0.76} | {over: q}
                worst = max(worst, abs(p - closed_form(kind, **given)))
        numbers[f"{over}: largest distance of fold and symmetry breaking from their closed forms"] = worst
        numbers[f"{over}: points of codimension two"] = {
            point.label: tuple(round(float(x), 6) for x in point.value) for point in chart.points.values()
        }
    return figure, numbers


if __name__ == "__main__":
    paper.run("charts", main)
