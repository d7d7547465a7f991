"""Response with a purely sliding absorber: averaged curves and simulated points.

Paper: figure with mu = 0.5, g = 0.211, G = 2.47; pure sliding is said to exist for h^2 <= C^2 <= 1 + h^2.
Damping: lambda = 0.9.

Confirms: the averaged curve is close to the linear response, and the simulated sliding motions lie on it
to O(eps). Contradicts the lower bound: below C^2 = h^2 (1 + 4/pi^2) the absorber sticks at every turn;
simulated motions between the two bounds are stick-slip (away from Omega = 1 the bound holds for C
Omega^2/(1 + eps)).
"""

import numpy as np
import paper

from orbits import multiple_scales as ms
from orbits.attractors import find_attractor


def main():
    flow = ms.SlowFlow()
    low, high = (float(x) for x in flow.sliding_bounds)
    figure = paper.figure(7.6, 4.8)
    axes = figure.add_subplot()
    sigma = np.linspace(-12, 12, 900)
    omega = 1 + paper.MASS_RATIO * sigma
    drag = paper.MASS_RATIO * flow.damping * omega
    alone = paper.MASS_RATIO * flow.forcing * np.abs((1 + 1j * drag) / (1 - omega**2 + 1j * drag))
    axes.plot(sigma, alone, color=paper.GREY, lw=0.8, label="oscillator alone")
    for k, curve in enumerate(ms.frequency_response(flow, "sliding")):
        line = curve.amplitude / (1 + paper.MASS_RATIO)
        axes.plot(curve.detuning, line, color="k", label="sliding, averaged" if k == 0 else None)
    axes.axhline(
        low, color=paper.GREEN, lw=1, ls=paper.DASHED, label=r"$h\sqrt{1+4/\pi^2}$: below, it sticks"
    )
    axes.axhline(flow.level, color=paper.RED, lw=1, ls=paper.DOTTED, label="$h$: lower bound as printed")
    axes.axhline(
        high, color=paper.BLUE, lw=1, ls=paper.DOT_DASHED, label=r"$\sqrt{1+h^2}$: above, it hits the walls"
    )

    worst, words = 0.0, {}
    for value in (
        -7.5,
        -7.0,
        -6.8,
        -6.2,
        -5.0,
        -4.0,
        -3.0,
        -2.2,
        -1.5,
        1.6,
        2.4,
        3.2,
        4.5,
        5.7,
        6.2,
        6.6,
        7.5,
    ):
        machine = paper.coupled(2.47, detuning=value)
        found = find_attractor(machine, transient=1500)
        if found.impacts or not found.nodes.size:
            continue
        height = paper.peak(found)
        sliding = found.text == "tt"
        axes.plot(
            value, height, "o" if sliding else "s", color=paper.RED, mfc=paper.RED if sliding else "w", ms=5
        )
        c = float(np.hypot(found.nodes[0, 2], found.nodes[0, 3] / machine.frequency))
        words[value] = (found.text, round(c, 5))
        near = ms.equilibria(flow, value)
        for s in near:
            if s.manifold == "sliding" and sliding:
                worst = max(worst, abs(s.amplitude - c))
    axes.plot([], [], "o", color=paper.RED, label="simulated, sliding")
    axes.plot([], [], "s", color=paper.RED, mfc="w", label="simulated, stick-slip")
    axes.set(xlabel=r"detuning $\sigma$", ylabel="$|q_1|_{\\max}/b$", ylim=(0, 1.3))
    paper.legend(axes, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    shaking = [
        (word, c * (1 + paper.MASS_RATIO * x) ** 2 / (1 + paper.MASS_RATIO)) for x, (word, c) in words.items()
    ]
    stick = [c for word, c in shaking if word != "tt"]
    slide = [c for word, c in shaking if word == "tt"]
    return figure, {
        "bounds of C: printed lower, true lower, upper": (
            round(float(flow.level), 5),
            round(low, 5),
            round(high, 5),
        ),
        "largest C Omega^2/(1 + eps) of a simulated stick-slip motion": max(stick, default=float("nan")),
        "smallest C Omega^2/(1 + eps) of a simulated sliding motion": min(slide, default=float("nan")),
        "largest difference in C between averaged and simulated sliding": worst,
        "simulated (sigma: word, C)": words,
    }


if __name__ == "__main__":
    paper.run("sliding_response", main)
