"""The same machine with and without friction: response curves and free decay.

Paper: figures with r = 0.76, g = 0.211, G = 2.47, mu = 0.5 and mu = 0; free vibration of both. Damping
(not printed): 0.9.

Confirms: friction narrows the frequency range, raises the activation threshold, and matters less the
larger the amplitude; the machine without friction does better above resonance, the one with friction
below it; friction drains faster while both are engaged. Refines: the rate alpha_c itself does not depend
on friction (larger friction does not give a "steeper" exponential); friction acts through the offset and
through beta_c, which falls with it. Its extra share of the damping ratio falls about like 1/C^2 up to C = 1 (far
beyond, as a small negative number over C). And it lets go earlier: after that the machine with friction is the
slower one, so at low amplitude it ends up behind.
"""

import numpy as np
import paper

from orbits import multiple_scales as ms
from orbits.simulation import simulate


def main():
    rubbing, smooth = ms.SlowFlow(), ms.SlowFlow(friction=0.0)
    figure, ((left, right),) = paper.panels(10.2, 4.4, 1, 2)
    numbers = {}
    ranges = {}
    for flow, color, name in ((rubbing, paper.BLUE, "mu = 0.5"), (smooth, paper.RED, "mu = 0")):
        for curve in ms.frequency_response(flow, points=3000):
            left.plot(curve.detuning, curve.amplitude, color=color, lw=0.9, alpha=0.45)
            left.plot(curve.detuning, np.where(curve.seen, curve.amplitude, np.nan), color=color, lw=1.7,
                      ls="-" if flow is rubbing else paper.DASHED, label=rf"${name}$".replace("mu", r"\mu"))  # fmt: skip
            seen = curve.detuning[curve.seen]
            ranges[name] = (seen[seen < 0].min(), seen[seen > 0].max())
            numbers[f"{name}: seen from sigma to sigma"] = tuple(round(float(x), 4) for x in ranges[name])
        numbers[f"{name}: C_min, C_max"] = (
            round(float(flow.activation.amplitude), 5), round(float(flow.symmetry_limit.amplitude), 5))  # fmt: skip
        numbers[f"{name}: alpha_c, beta_c, offset"] = tuple(
            round(float(x), 5) for x in (lambda c: (c.alpha_c, c.beta_c, c.offset_c))(ms.coefficients(flow))
        )
    left.set(xlabel=r"detuning $\sigma$ (pale: not seen)", ylabel="$C$", ylim=(0, 1.5), xlim=(-7, 7))
    paper.legend(left, loc="upper left")
    for sigma in (-4.0, -3.0, 2.0, 3.0):
        pair = []
        for flow in (rubbing, smooth):
            seen = [s.amplitude for s in ms.equilibria(flow, sigma) if s.seen and s.manifold == "impacting"]
            pair.append(round(max(seen), 5) if seen else None)
        numbers[f"C at sigma = {sigma} with, without friction"] = tuple(pair)
    for c in (0.3, 0.5, 1.0, 2.0):
        with_, without = float(ms.damping_ratio(rubbing, c)), float(ms.damping_ratio(smooth, c))
        numbers[f"damping ratio at C = {c} with, without friction"] = (round(with_, 6), round(without, 6))

    start, periods = 0.72, 130
    for mu, color, name in ((0.5, paper.BLUE, r"$\mu=0.5$"), (0.0, paper.RED, r"$\mu=0$")):
        machine = paper.coupled(0.0, detuning=0.0, friction=mu)
        run = simulate(machine, paper.on_manifold(machine, start), periods=periods)
        seen = run.sample(per_period=40)
        height = np.sqrt(seen.v**2 + seen.v_rate**2)
        turns = (seen.phase - seen.phase[0]) / (2 * np.pi)
        right.plot(turns, height, color=color, ls="-" if mu else paper.DASHED, label=name)
        flow = ms.SlowFlow(forcing=0.0, friction=mu)
        right.plot(
            turns,
            ms.decay_amplitude(flow, start, 2 * np.pi * paper.MASS_RATIO * turns),
            color="k",
            lw=0.8,
            label=None if mu else "slow flow",
        )
        bound = ms.decay_bound(flow, start, 2 * np.pi * paper.MASS_RATIO * turns)
        right.plot(
            turns, bound, color=color, lw=0.8, ls=paper.DOTTED, label=None if mu else "exponential bound"
        )
        for mark in (40, 125):
            numbers[f"mu = {mu}: simulated C after {mark} periods"] = float(np.interp(mark, turns, height))
        numbers[f"mu = {mu}: periods to release, slow flow"] = float(
            ms.decay_time(flow, start) / (2 * np.pi * paper.MASS_RATIO)
        )
    turns = np.linspace(0, periods, 200)
    right.plot(turns, start * np.exp(-0.5 * paper.MASS_RATIO * paper.DAMPING * 2 * np.pi * turns), color=paper.GREY,
               ls=paper.DOTTED, label="oscillator alone")  # fmt: skip
    right.set(
        xlabel="periods",
        ylabel="$C$ of the free motion",
        ylim=(0, 0.75),
    )
    paper.legend(right, loc="upper right")
    return figure, numbers


if __name__ == "__main__":
    paper.run("friction_or_none", main)
