"""Response with an impacting absorber, averaged and simulated; backbone.

Paper: figure with mu = 0.5, g = 0.211, G = 2.47: stable and unstable parts of the averaged response;
formulas of the backbone. Damping (not printed): lambda = 0.9.

Confirms: the stable part (between C_min and C_max, eigenvalues in the left half plane) is what the
machine does, to O(eps). Contradicts: the printed resonance frequency (eps/(2 b q)(... sqrt(q - q_min)
...)) has the wrong dimension; with eps b^2/(2 q^2) and sqrt(C^2 - C_min^2) it passes through the
phase-resonant states. Refines: the slow flow has two folds and a
Hopf point on this response; one fold and the Hopf point lie on the repelling part and are never seen.
That is no accident: the trace of the slow flow is -lambda - (8/pi) R B/(d(C^2)/dB), free of phase and
forcing and negative wherever the manifold attracts.
"""

import numpy as np
import paper

from orbits import multiple_scales as ms
from orbits.attractors import find_attractor


def printed_resonance(q, flow):
    """f_R/f_0 as printed, with q in half-widths of the cavity (b = 1)."""
    c = ms.coefficients(flow)
    rise = np.sqrt(q - flow.activation.amplitude)
    return 1 + flow.mass_ratio * (
        (c.offset_gamma - c.beta_gamma * rise) / (2 * q) - 1 / (np.pi**2 / 4 + flow.loss**2)
    )


def main():
    flow = ms.SlowFlow()
    figure = paper.figure(7.8, 5.0)
    axes = figure.add_subplot()
    sigma = np.linspace(-7, 7, 900)
    omega = 1 + paper.MASS_RATIO * sigma
    drag = paper.MASS_RATIO * flow.damping * omega
    alone = paper.MASS_RATIO * flow.forcing * np.abs((1 + 1j * drag) / (1 - omega**2 + 1j * drag))
    axes.plot(sigma, alone, color=paper.GREY, label="oscillator alone")
    numbers = {}
    for curve in ms.frequency_response(flow, points=2000):
        shown = np.where(curve.seen, curve.amplitude, np.nan)
        axes.plot(curve.detuning, curve.amplitude, color=paper.PALE, lw=1.2, label="averaged, not seen")
        axes.plot(curve.detuning, shown, color=paper.BLUE, lw=2.4, label="averaged, stable")
        for point in ms.special_points(curve):
            s = point.state
            if point.kind in ("fold", "hopf"):
                mark, name = ("s", "fold") if point.kind == "fold" else ("h", "Hopf")
                axes.plot(s.detuning, s.amplitude, mark, color=paper.PURPLE, ms=6, label=f"averaged: {name}")
                side = "attracting" if s.attracting else "repelling"
                numbers[f"{point.kind} on the {side} part (sigma, B, C^2)"] = (
                    round(s.detuning, 5), round(s.velocity, 5), round(s.amplitude**2, 5))  # fmt: skip
    line = ms.backbone(flow, np.linspace(float(flow.activation.velocity), 1.2, 200))
    axes.plot(line.detuning, line.amplitude, color=paper.GREEN, ls=paper.DASHED, label="backbone")
    q = line.amplitude[1:]
    axes.plot((printed_resonance(q, flow) - 1) / paper.MASS_RATIO, q, color=paper.GREEN, ls=paper.DOTTED, lw=1.2,
              label="backbone as printed")  # fmt: skip

    worst = 0.0
    for value in (-4.6, -4.2, -3.6, -3.0, -2.58, 0.9, 1.3, 1.8, 2.4, 3.0, 3.6, 4.0):
        machine = paper.coupled(2.47, detuning=value)
        state = max((s for s in ms.equilibria(flow, value) if s.seen and s.manifold == "impacting"),
                    key=lambda s: s.amplitude, default=None)  # fmt: skip
        if state is None:
            continue
        found = find_attractor(machine, paper.at_equilibrium(machine, state), transient=800)
        if found.impacts != 2 or not found.symmetric:
            continue
        c = float(np.hypot(found.nodes[0, 2], found.nodes[0, 3] / machine.frequency))
        axes.plot(value, c, "o", color=paper.RED, ms=4)
        worst = max(worst, abs(c - state.amplitude) / state.amplitude)
    axes.plot([], [], "o", color=paper.RED, ms=4, label="simulated, two symmetric impacts")
    for level, name in ((flow.activation.amplitude, r"\min"), (flow.symmetry_limit.amplitude, r"\max")):
        axes.axhline(float(level), color="k", lw=0.7)
        axes.text(6.9, float(level) + 0.015, f"$C_{{{name}}}$", ha="right")
    axes.set(xlabel=r"detuning $\sigma$", ylabel="$C$", ylim=(0, 1.6), xlim=(-7, 7))
    handles = {str(h.get_label()): h for h in axes.get_legend_handles_labels()[0]}
    paper.legend(axes, loc="upper left", handles=list(handles.values()))
    b = 1.0
    at = ms.backbone(flow, [b])
    numbers |= {
        "largest relative difference in C, averaged to simulated": worst,
        "backbone at B = 1: C, sigma_R": (round(float(at.amplitude[0]), 5), round(float(at.detuning[0]), 5)),
        "sigma_R there as printed": float((printed_resonance(at.amplitude[0], flow) - 1) / paper.MASS_RATIO),
    }
    return figure, numbers


if __name__ == "__main__":
    paper.run("impacting_response", main)
