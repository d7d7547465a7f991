"""Two starts, two motions: sliding from rest, impacting from q1 = q2 = b; both projected on the slow planes.

Paper: two figures with r = 0.76, mu = 0.5, g = 0.211, G = 2.47, sigma = -2.58. Damping (not printed):
lambda = 0.9, with which both come true.

Confirms: from rest the motion settles on the sliding manifold, from q1 = q2 = 0.02 m on the impacting
one; both end on the steady states of the slow flow to O(eps), and the slow flow follows the transient.
Confirms too that friction removes irregular responses: at G = 1.65, sigma = 5 no impacting state
attracts, and from q1 = q2 = b the machine without friction never settles while the one with friction
slides. Refines: from rest the machine without friction does not respond irregularly either, its absorber
simply stays where it is; the start decides.
"""

import numpy as np
import paper

from orbits import multiple_scales as ms
from orbits.attractors import find_attractor
from orbits.simulation import simulate


def envelope(run):
    """C^2 and gamma of a simulated motion, once per half period."""
    seen = run.sample(per_period=2)
    omega = run.model.frequency
    gamma = np.arctan2(seen.v, seen.v_rate / omega) - seen.phase
    return seen.v**2 + (seen.v_rate / omega) ** 2, np.angle(np.exp(1j * gamma))


def unbroken(angle):
    """An angle with gaps where it is counted anew from -pi."""
    return np.where(np.abs(np.diff(angle, prepend=angle[0])) > np.pi, np.nan, angle)


def main():
    machine = paper.coupled(2.47, detuning=-2.58)
    flow = ms.SlowFlow()
    states = [s for s in ms.equilibria(flow, -2.58) if s.seen]
    figure, panels = paper.panels(11.6, 6.6, 2, 4)
    numbers = {}
    b = np.linspace(0, 1.25, 400)
    for row, start, kind in zip(panels, ({}, {"q1": 1.0, "q2": 1.0}), ("sliding", "impacting")):
        run = simulate(machine, start, periods=500)
        found = find_attractor(machine, start, transient=900)
        state = next(s for s in states if s.manifold == kind)
        paper.portrait(row[:2], machine, found.state, 2)
        row[0].set_title(f"from {'rest' if not start else '$q_1=q_2=b$'}: {found.text}")
        squared, gamma = envelope(run)
        row[2].plot(b, ms.squared_amplitude(b, flow.loss, flow.level), color=paper.PALE)
        row[2].plot([0, 0], [float(x) ** 2 for x in flow.sliding_bounds], color=paper.PALE, lw=3)
        if kind == "impacting":
            slow = paper.slow_variables(run)
            row[2].plot(slow["B"], slow["C2"], color=paper.GREEN, lw=0.8, marker=".", ms=2)
        else:
            row[2].plot(np.zeros_like(squared), squared, color=paper.GREEN, lw=0.8, marker=".", ms=2)
        for s in states:
            row[2].plot(s.velocity, s.amplitude**2, "o", color=paper.RED)
        row[3].plot(unbroken(gamma), squared, color=paper.GREEN, lw=0.9, label="simulated")
        first = 20
        follow = ms.integrate(flow, -2.58, float(np.sqrt(squared[first])), float(gamma[first]), 12.0, kind) \
            if kind == "sliding" and squared[first] > flow.sliding_bounds[0] ** 2 else None  # fmt: skip
        if kind == "impacting":
            slow = paper.slow_variables(run)
            on = int(np.argmax(slow["time"] > 0.6))
            follow = ms.integrate(flow, -2.58, float(np.sqrt(slow["C2"][on])), float(slow["gamma"][on]), 12.0)
        if follow is not None:
            row[3].plot(
                follow.phase,
                follow.amplitude**2,
                color=paper.BLUE,
                lw=1.2,
                ls=paper.DASHED,
                label="slow flow",
            )
        row[3].plot(state.phase, state.amplitude**2, "o", color=paper.RED)
        row[2].set(xlabel="$B$", ylabel="$C^2$", ylim=(0, 1.1))
        row[3].set(xlabel=r"$\gamma$", ylabel="$C^2$")
        paper.legend(row[3], loc="best")
        if kind == "sliding":
            paper.legend(row[0], loc="upper right")
            row[0].set(ylim=(-1.1, 1.65))
        c = found.nodes[0, 2] ** 2 + (found.nodes[0, 3] / machine.frequency) ** 2
        numbers[f"{kind}: word"] = found.text
        numbers[f"{kind}: C^2 simulated, slow flow"] = (round(float(c), 6), round(state.amplitude**2, 6))
    for mu in (0.0, 0.5):
        other = paper.coupled(1.65, detuning=5.0, friction=mu)
        for name, start in (("rest", {}), ("q1 = q2 = b", {"q1": 1.0, "q2": 1.0})):
            quiet = find_attractor(other, start, transient=1500)
            word = quiet.text if quiet.periods else ""
            numbers[f"G = 1.65, sigma = 5, mu = {mu}, from {name}"] = (quiet.kind, word, quiet.periods)
    return figure, numbers


if __name__ == "__main__":
    paper.run("coexistence_runs", main)
