"""Brute-force sweeps through resonance, up and down, over the averaged response, with phase portraits on
the way.

Paper: two figures for r = 0.76, mu = 0.5, g = 0.211, G = 2.47. Damping (not printed): lambda = 0.9.

Confirms: the machine follows the stable averaged branches, jumps where they end, and passes through
asymmetric motions with two, three and more impacts near resonance. Refines: the sweep up stays on the
sliding branch up to where it meets the walls (C = 1 and more), the sweep down comes along the impacting
one; near resonance there are motions that never repeat.
"""

from collections import Counter

import numpy as np
import paper

from orbits import multiple_scales as ms
from orbits.attractors import sweep
from orbits.simulation import simulate

STYLES = {"sliding": ("o", "k", "sliding, stick-slip"), "stuck": ("x", paper.GREY, "stuck"),
          "chaotic": (".", paper.PURPLE, "nothing repeats"), "chatter": ("+", paper.GREY, "chatter")}  # fmt: skip


def main():
    flow = ms.SlowFlow()
    frequencies = np.linspace(0.94, 1.045, 106)
    figure = paper.figure(11.0, 8.4 if not paper.narrow() else 24.0)
    across = 3 if paper.narrow() else 6
    grid = figure.add_gridspec(2 + 6 // across, across, height_ratios=(1.5, 1.5, *[1] * (6 // across)))
    numbers = {}
    chosen = []
    for place, values, name in ((0, frequencies, "up"), (1, frequencies[::-1], "down")):
        axes = figure.add_subplot(grid[place, :])
        for curve in ms.frequency_response(flow) + ms.frequency_response(flow, "sliding"):
            color = paper.PALE if curve.manifold == "impacting" else "#bbbbbb"
            axes.plot(curve.frequency, curve.amplitude / (1 + paper.MASS_RATIO), color=color, lw=0.8)
            shown = np.where(curve.seen, curve.amplitude, np.nan) / (1 + paper.MASS_RATIO)
            axes.plot(curve.frequency, shown, color=color, lw=3)
        rows = sweep(paper.coupled(2.47, frequency=values[0]), "frequency", values, transient=300)
        named = set()
        for row in rows:
            symmetric = row.attractor == "periodic" and row.word == "LR" and row.detail.symmetric
            if symmetric:
                marker, color, label = "s", paper.BLUE, "two symmetric impacts"
            elif row.attractor == "periodic":
                marker, color, label = "^", paper.RED, "other periodic motions with impacts"
            else:
                marker, color, label = STYLES[row.attractor]
            known = label in named
            named.add(label)
            axes.plot(
                row.value,
                row.measures["max_abs_q1"],
                marker,
                color=color,
                ms=2.5 if paper.narrow() else 4,
                label=None if known else label,
            )
        axes.set(ylim=(0, 2.4), ylabel="$|q_1|_{\\max}/b$", title=f"sweep {name}")
        if name == "up":  # the sweep down meets the same motions
            paper.legend(axes, loc="upper left")
        kinds = Counter(
            "LR symmetric" if r.word == "LR" and r.detail.symmetric else r.word if r.periods else r.attractor
            for r in rows
        )
        numbers[f"{name}: motions met"] = dict(kinds.most_common(8))
        heights = np.array([r.measures["max_abs_q1"] for r in rows])
        outer = [
            i for i in range(len(rows) - 1) if rows[i].word == "tt" and rows[i + 1].attractor != "sliding"
        ] + [i for i in range(len(rows) - 1) if rows[i].word == "LR" and rows[i + 1].word in ("tt", "ss")]
        numbers[f"{name}: between sliding and impacts (Omega, |q1|/b before, after)"] = [
            (round(float(rows[i + 1].value), 4), round(float(heights[i]), 3), round(float(heights[i + 1]), 3))
            for i in outer
        ]
        numbers[f"{name}: largest |q1|/b"] = float(heights.max())
        wanted = {}
        for r in rows:
            if r.attractor == "periodic":
                wanted.setdefault((r.word, r.detail.symmetric), r)
        chosen += [(name, r) for r in wanted.values()]
    axes.set_xlabel(r"$\Omega$")
    seen = []
    for name, row in chosen:
        if row.word not in seen and len(seen) < 6 and row.periods <= 3:
            panel = figure.add_subplot(grid[2 + len(seen) // across, len(seen) % across])
            seen.append(row.word)
            machine = paper.coupled(2.47, frequency=row.value)
            settled = simulate(machine, row.detail.state, periods=1500).end
            motion = paper.sampled(simulate(machine, settled, periods=row.periods), 800)
            panel.plot(motion.w, motion.w_rate, color=paper.RED, lw=1)
            panel.set(xlabel="$w$", xlim=(1.05, -1.05))  # the left wall, w = +1, on the left
            panel.set(ylabel="$w'$" if len(seen) % across == 1 else "")
            panel.set_title(
                f"{row.word[:12]}, {row.value:.3f}" + ("" if paper.narrow() else f", {name}"),
                fontsize="small",
            )
    numbers["portraits"] = seen
    return figure, numbers


if __name__ == "__main__":
    paper.run("sweeps", main)
