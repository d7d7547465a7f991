"""Free vibration with an engaged absorber, and its projection on the slow invariant manifold.

Paper: the example of the sought motion (mu = 0.5, g = 0.211) and the projection of a free motion on the
manifold (mu = 0.3, g = 0.355). It says that the stable branch of the manifold lies inside the validity
range 0 < C < B - h, and that engagement ends at (B_min, C_min). Damping (not printed): lambda = 0.9, as
everywhere here.

Confirms: the impacts follow the manifold to O(eps) and let go near C_min; both ends of the attracting
part satisfy C < B - h for this machine. Refines: the condition is sufficient, not necessary, and other
machines violate it on their whole attracting part (r = 0.5, mu g = 0.15) while their symmetric orbits are
real. The time of the decay agrees with the closed form of the slow flow to O(eps), which is too coarse to
tell the two closures apart here; closure.py does.
"""

import numpy as np
import paper

from orbits import Absorber
from orbits import multiple_scales as ms
from orbits.simulation import simulate


def main():
    example = paper.coupled(0.0, detuning=0.0)
    run = simulate(example, paper.on_manifold(example, 0.7), periods=6)
    machine = paper.coupled(0.0, detuning=0.0, **paper.MIDDLE)
    flow = ms.SlowFlow(forcing=0.0, friction=0.3, gravity=0.355)
    start = 0.72
    free = simulate(machine, paper.on_manifold(machine, start), periods=60)
    slow = paper.slow_variables(free)
    low = flow.activation
    predicted = ms.squared_amplitude(slow["B"], flow.loss, flow.level)
    engaged = np.cumsum(np.abs(slow["C2"] - predicted) > 0.05 + 0.1 * slow["C2"]) == 0
    released = slow["time"][engaged][-1]
    above = engaged & (slow["C2"] > 1.1 * low.amplitude**2)
    half = 0.6 * start
    passed = float(np.interp(-(half**2), -slow["C2"][engaged], slow["time"][engaged]))

    figure, ((left, right),) = paper.panels(9.6, 4.2, 1, 2)
    seen = run.sample(per_period=300)
    turns = (seen.phase - seen.phase[0]) / (2 * np.pi)
    left.plot(turns, seen.w - seen.v, color=paper.BLUE, label=r"$\Phi=w-v$")
    left.plot(turns, seen.w, color=paper.PALE, lw=1, label="$w$")
    left.plot(turns, seen.v, color=paper.GREY, lw=1, ls=paper.DASHED, label="$v$")
    left.set(xlabel=r"$\tau/2\pi$", title=r"$\mu=0.5$, $\tilde g=0.211$", xlim=(0, 6), ylim=(-1.8, 2.2))
    paper.legend(left, loc="upper right", ncols=3)
    b = np.linspace(0, 1.3, 400)
    right.plot(b, ms.squared_amplitude(b, flow.loss, flow.level), color="k", label="manifold")
    right.plot(
        b,
        ms.squared_amplitude(b, flow.loss, 0.0),
        color=paper.GREEN,
        ls=paper.DOTTED,
        label=r"manifold, $\mu=0$",
    )
    right.plot(slow["B"], slow["C2"], ".", color=paper.RED, ms=3, label="simulated impacts")
    edge = np.maximum(b - flow.level, 0.0) ** 2
    right.fill_between(b, 0, edge, color="#dbe6f1", lw=0, label=r"$C<B-h$")
    right.plot(
        *[low.velocity, low.amplitude**2], "o", color=paper.BLUE, label="where it lets go: $B_{\\min}$"
    )
    right.set(
        xlabel="$B$", ylabel="$C^2$", ylim=(0, 1.0), xlim=(0, 1.3), title=r"$\mu=0.3$, $\tilde g=0.355$"
    )
    paper.legend(right, loc="upper center")

    rough = ms.SlowFlow(restitution=0.5, friction=1.0, gravity=0.15)
    ends = [ms.reversal_bound(p.amplitude, p.velocity, flow.level) for p in (low, flow.symmetry_limit)]
    bad = [
        ms.reversal_bound(p.amplitude, p.velocity, rough.level)
        for p in (rough.activation, rough.symmetry_limit)
    ]
    return figure, {
        "largest distance of the impacts from the manifold, in C^2, above 1.1 C^2_min": float(
            np.max(np.abs(slow["C2"] - predicted)[above])
        ),
        "C^2 where the simulated absorber lets go": float(slow["C2"][engaged][-1]),
        "C^2_min of the manifold": float(low.amplitude**2),
        "slow time to 0.6 of the amplitude, simulated": passed,
        "slow time to 0.6 of the amplitude, exact closure": float(ms.decay_time(flow, start, half)),
        "slow time to 0.6 of the amplitude, closure of the paper": float(
            ms.decay_time(flow.with_(closure="paper"), start, half)
        ),
        "slow time to release, simulated": float(released),
        "slow time to release, exact closure": float(ms.decay_time(flow, start)),
        "slow time to release, closure of the paper": float(
            ms.decay_time(flow.with_(closure="paper"), start)
        ),
        "B - h - C at B_min and B_max (paper's machine)": tuple(round(float(x), 4) for x in ends),
        "B - h - C at B_min and B_max (r = 0.5, mu g = 0.15)": tuple(round(float(x), 4) for x in bad),
        "least margin of that machine's symmetric orbits between them": min(
            Absorber(restitution=0.5, friction=1.0, gravity=0.15).symmetric_orbit(float(c)).margin
            for c in np.linspace(1.001 * rough.activation.amplitude, rough.symmetry_limit.amplitude, 20)
        ),
    }


if __name__ == "__main__":
    paper.run("free_motion", main)
