"""All averaged responses in one picture, in millimetres and hertz: impacting, sliding, stuck.

Paper: figure for r = 0.76, mu = 0.5, g = 0.211, G = 2.47, with the bounds q1_min, q1_max, the sliding
range and q1_cr. Damping (not printed): lambda = 0.9.

Confirms: three regimes and their bounds; stable impacting and sliding branches coexist over the ranges
printed below. Refines: the conversion q1 = b C/(1 + eps) leaves out eps w/(1 + eps), up to 0.6 % of b;
and between q1_cr and the true lower bound of sliding the machine does stick-slip, which no averaged
branch covers.
"""

import numpy as np
import paper

from orbits import multiple_scales as ms
from orbits.design import Design


def main():
    flow = ms.SlowFlow()
    machine = Design(cavity=paper.HALF_WIDTH, natural_frequency=paper.NATURAL_FREQUENCY)
    base = float(machine.excitation(flow.forcing))
    scale = 1e3 * paper.HALF_WIDTH / (1 + paper.MASS_RATIO)

    def hertz(detuning):
        return paper.NATURAL_FREQUENCY * flow.frequency(detuning)

    figure = paper.figure(8.4, 5.4)
    axes = figure.add_subplot()
    f = np.linspace(6.8, 8.6, 1500)
    stuck = machine.linear_response(f, base, stuck=True)
    held = machine.is_stuck(f, base)
    axes.plot(
        f,
        1e3 * machine.linear_response(f, base),
        color="#a8a8a8",
        lw=1,
        ls=paper.DOTTED,
        label="oscillator alone",
    )
    axes.plot(f, np.where(held, 1e3 * stuck, np.nan), color="k", ls=paper.DASHED, label="stuck")
    axes.plot(
        f,
        1e3 * machine.sticking_limit(f),
        color=paper.GREEN,
        lw=1,
        ls=paper.DOT_DASHED,
        label=r"$q_{1,\mathrm{cr}}$",
    )
    ranges = {}
    for curve in ms.frequency_response(flow, points=3000):
        line = scale * curve.amplitude
        axes.plot(hertz(curve.detuning), line, color=paper.PALE, lw=1, label="impacting, not seen")
        axes.plot(
            hertz(curve.detuning),
            np.where(curve.seen, line, np.nan),
            color=paper.BLUE,
            lw=2.4,
            label="impacting",
        )
        seen = curve.detuning[curve.seen]
        ranges["impacting"] = [
            (seen[seen < 0].min(), seen[seen < 0].max()),
            (seen[seen > 0].min(), seen[seen > 0].max()),
        ]
    ranges["sliding"] = []
    for k, curve in enumerate(ms.frequency_response(flow, "sliding")):
        axes.plot(
            hertz(curve.detuning),
            scale * curve.amplitude,
            color="k",
            lw=1.2,
            label="sliding" if not k else None,
        )
        ranges["sliding"].append((curve.detuning.min(), curve.detuning.max()))
    low, high = machine.sliding_bounds
    for level, style in (
        (machine.activation_threshold, "-"),
        (machine.upper_bound, "-"),
        (low, paper.DOTTED),
        (high, paper.DOTTED),
    ):
        axes.axhline(1e3 * level, color=paper.RED, lw=0.8, ls=style)
    axes.text(8.58, 1e3 * machine.upper_bound + 0.2, "$q_{1,\\max}$", ha="right")
    axes.text(8.58, 1e3 * machine.activation_threshold + 0.2, "$q_{1,\\min}$", ha="right")
    axes.text(8.58, 1e3 * high + 0.2, "sliding ends", ha="right", fontsize="small")
    axes.text(8.58, 1e3 * low - 0.2, "sliding begins", ha="right", va="top", fontsize="small")
    axes.set(xlabel="$f$ [Hz]", ylabel="$|q_1|_{\\max}$ [mm]", ylim=(0, 29), xlim=(6.8, 8.6))
    paper.legend(axes, loc="upper left")
    numbers = {
        "q1_min, q1_max in mm": (
            round(1e3 * float(machine.activation_threshold), 4), round(1e3 * float(machine.upper_bound), 4)),
        "sliding from, to in mm": (round(1e3 * float(low), 4), round(1e3 * float(high), 4)),
    }  # fmt: skip
    for kind, pieces in ranges.items():
        for a, b in sorted(pieces):
            numbers[f"{kind}, seen from {float(hertz(a)):.4f} Hz to"] = float(hertz(b))
    return figure, numbers


if __name__ == "__main__":
    paper.run("combined_response", main)
