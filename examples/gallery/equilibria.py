"""Steady states as intersections of two curves, for four detunings.

Paper: figure with G = 1.65, r = 0.76, mu = 0.5, g = 0.105 and sigma = 5.1, 1.25, 3.65, -4.4. Damping (not
printed): 0.9.

Confirms: only common points of the purple curve and the manifold are steady states; their number goes 0,
2, 1, 1 or so with the detuning (the printed numbers tell). Contradicts: sigma = 5.1 is Omega = 1.0306 for
eps = 0.006, not 1.039 as printed above the first panel; the other three labels are right. Every root is
found: the quartic in B has no others.
"""

import numpy as np
import paper

from orbits import multiple_scales as ms

DETUNINGS = (5.1, 1.25, 3.65, -4.4)
PRINTED = (1.039, 1.007, 1.022, 0.973)


def main():
    flow = ms.SlowFlow(forcing=1.65, gravity=0.105)
    figure, panels = paper.panels(8.6, 6.6, 2, 2, sharex=True, sharey=True)
    numbers = {}
    b = np.linspace(0.0, 1.6, 1200)
    manifold, k1, k2 = flow.harmonics(b)
    for axes, sigma, label in zip(panels.flat, DETUNINGS, PRINTED):
        stiff = flow.damping**2 + 4 * sigma**2
        middle = (2 * flow.damping * k1 + 4 * sigma * k2 + flow.forcing**2) / (2 * stiff)
        with np.errstate(invalid="ignore"):
            spread = np.sqrt(middle**2 - (k1**2 + k2**2) / stiff)
        axes.plot(b, manifold, color="k", label="slow invariant manifold")
        for sign in (-1, 1):
            name = "forced balance" if sign > 0 else None
            axes.plot(b, middle + sign * spread, color=paper.PURPLE, ls=paper.DASHED, label=name)
        states = [s for s in ms.equilibria(flow, sigma) if s.manifold == "impacting"]
        for s in states:
            kind = "seen" if s.seen else "unstable or repelling"
            axes.plot(
                s.velocity, s.amplitude**2, "o", color=paper.RED, mfc=paper.RED if s.seen else "w", ms=7
            )
            numbers[f"sigma = {sigma}: (B, C^2), {kind}"] = (round(s.velocity, 5), round(s.amplitude**2, 5))
        omega = float(flow.frequency(sigma))
        numbers[f"sigma = {sigma}: steady states with impacts"] = len(states)
        numbers[f"sigma = {sigma}: Omega (printed {label})"] = omega
        axes.set(ylim=(0, 1.2), title=rf"$\sigma={sigma}$, $\Omega={omega:.4f}$")
        axes.set(xlabel="$B$" if axes.get_subplotspec().is_last_row() else "")
        axes.set(ylabel="$C^2$" if axes.get_subplotspec().is_first_col() else "")
    axes.plot([], [], "o", color=paper.RED, ms=7, label="steady state, seen")
    axes.plot([], [], "o", color=paper.RED, mfc="w", ms=7, label="not seen")
    columns = 2 if paper.narrow() else 4
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=columns)
    return figure, numbers


if __name__ == "__main__":
    paper.run("equilibria", main)
