"""Steady states on both slow manifolds at one excitation.

Paper: figure with r = 0.76, mu = 0.5, g = 0.211, G = 2.47, sigma = -2.58: one stable and one unstable
steady state with impacts, and one on the sliding manifold B = 0. Damping (not printed): lambda = 0.9.

Confirms: exactly three steady states; the impacting one on the attracting part and the sliding one are
both stable. Refines: the second impacting one is stable along the manifold (eigenvalues in the left half
plane); it is unseen because the manifold repels there. The paper calls it unstable without saying which.
And the sliding part of B = 0 begins at h^2 (1 + 4/pi^2), not at h^2.
"""

import numpy as np
import paper

from orbits import multiple_scales as ms


def main():
    flow = ms.SlowFlow()
    states = ms.equilibria(flow, -2.58)
    rough = ms.equilibria(flow.with_(closure="paper"), -2.58)
    figure = paper.figure(7.0, 5.0)
    axes = figure.add_subplot()
    b = np.linspace(0, 1.25, 500)
    manifold = ms.squared_amplitude(b, flow.loss, flow.level)
    axes.plot(b, manifold, color=paper.PALE, lw=1.2, label="manifold, repelling")
    axes.plot(
        b,
        np.where(flow.attracts(b), manifold, np.nan),
        color=paper.BLUE,
        lw=2.4,
        label="manifold, attracting",
    )
    low, high = (float(x) ** 2 for x in flow.sliding_bounds)
    axes.plot([0, 0], [low, high], color=paper.BLUE, lw=2.4)
    axes.plot(
        [0, 0],
        [flow.level**2, low],
        color=paper.RED,
        lw=2.4,
        ls=paper.DOTTED,
        label="stick-slip, not sliding",
    )
    numbers = {"steady states": len(states)}
    for s, r in zip(states, rough):
        axes.plot(
            s.velocity, s.amplitude**2, "o", color=paper.RED, mfc=paper.RED if s.seen else "w", ms=8, zorder=5
        )
        name = f"{s.manifold}, {'attracting' if s.attracting else 'repelling'}"
        numbers[f"{name}: B, C^2, gamma"] = (
            round(s.velocity, 6), round(s.amplitude**2, 6), round(s.phase, 6))  # fmt: skip
        numbers[f"{name}: B, C^2 with the closure of the paper"] = (
            round(r.velocity, 6),
            round(r.amplitude**2, 6),
        )
        numbers[f"{name}: eigenvalues"] = tuple(
            complex(round(v.real, 4), round(v.imag, 4)) for v in s.eigenvalues
        )
    axes.plot([], [], "o", color=paper.RED, ms=8, label="steady state, seen")
    axes.plot([], [], "o", color=paper.RED, mfc="w", ms=8, label="steady state, not seen")
    axes.set(xlabel="$B$", ylabel="$C^2$", ylim=(0, 1.1), xlim=(-0.05, 1.25))
    paper.legend(axes, loc="upper center")
    return figure, numbers


if __name__ == "__main__":
    paper.run("coexisting_equilibria", main)
