"""The simulation of an inclined cavity with unlike walls and frictions, against a plain integration with event detection."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from orbits import Cavity
from orbits.simulation import simulate

MACHINE = {
    "restitution_left": 0.9, "restitution_right": 0.5, "friction_left": 0.1, "friction_right": 0.9, "gravity": 0.5,
    "mass_ratio": 0.2, "frequency": 1.3, "slope": 0.15, "distance_left": 1.2, "distance_right": 0.7,
}  # fmt: skip


def witness(amplitude, psi, w, rate, count):
    """Letters and phases of the first events: w'' = -C Omega^2 sin Psi - b - s a_s, sliding, sticking and hitting as Newton says."""
    m = MACHINE
    weight, Omega = (1 + m["mass_ratio"]) * m["gravity"], m["frequency"]
    b, normal = weight * math.sin(m["slope"]), weight * math.cos(m["slope"])
    a = {1: normal * m["friction_left"], -1: normal * m["friction_right"]}
    left, right = m["distance_left"], -m["distance_right"]

    def push(phase):
        return -amplitude * Omega**2 * math.sin(phase) - b

    def way_from_rest():
        return 1 if push(psi) > a[1] + 1e-12 else -1 if push(psi) < -a[-1] - 1e-12 else 0

    letters, phases = "", []
    mode = int(np.sign(rate)) or way_from_rest()
    while len(letters) < count:
        if mode == 0:
            grid = psi + np.linspace(0.0, 2.0 * math.pi, 4001)
            reserves = [(s, [a[s] - s * push(x) for x in grid]) for s in (1, -1)]
            first = [
                (next((i for i in range(1, 4001) if r[i] < 0.0 <= r[i - 1]), 9999), s) for s, r in reserves
            ]
            i, mode = min(first)
            psi = brentq(lambda x, s=mode: a[s] - s * push(x), grid[i - 1], grid[i], xtol=1e-14)
            letters, phases = letters + "u", [*phases, psi]
            continue

        def motion(tau, y, s=mode, start=psi):
            return y[1], push(start + Omega * tau) - s * a[s]

        def stops(tau, y, s=mode):
            return s * y[1] + (1e-30 if tau == 0.0 else 0.0)

        def wall(tau, y, s=mode):
            return left - y[0] if s > 0 else y[0] - right

        for event in (stops, wall):
            event.terminal, event.direction = True, -1
        run = solve_ivp(
            motion, (0.0, 40.0), (w, rate), events=(stops, wall), rtol=1e-11, atol=1e-12, max_step=0.05
        )
        psi, (w, rate) = psi + Omega * run.t[-1], run.y[:, -1]
        if run.t_events[1].size:
            letters, w = letters + ("L" if mode > 0 else "R"), left if mode > 0 else right
            rate *= -m["restitution_left" if mode > 0 else "restitution_right"]
            mode = -mode
        else:
            rate, before = 0.0, mode
            mode = way_from_rest()
            letters += "t" if mode == -before else "s"
        phases.append(psi)
    return letters, phases


@pytest.mark.parametrize(
    ("amplitude", "start"),
    [(0.5, (0.4, 0.3, 0.9)), (0.8, (2.0, -0.2, -1.0)), (1.5, (4.0, 0.1, 1.5)), (0.35, (1.0, 0.0, 0.8))],
)
def test_events_are_those_of_a_plain_integration(amplitude, start):
    psi, w, rate = start
    letters, phases = witness(amplitude, psi, w, rate, 9)
    run = simulate(Cavity(**MACHINE), {"phase": psi, "w": w, "w_rate": rate}, events=9, amplitude=amplitude)
    assert run.letters == letters
    assert run.phases == pytest.approx(phases, abs=1e-6)


def test_the_starts_meet_every_kind_of_event():
    seen = set()
    for amplitude, start in ((0.5, (0.4, 0.3, 0.9)), (0.8, (2.0, -0.2, -1.0)), (1.5, (4.0, 0.1, 1.5))):
        run = simulate(
            Cavity(**MACHINE), dict(zip(("phase", "w", "w_rate"), start)), events=9, amplitude=amplitude
        )
        seen |= set(run.letters)
    assert seen >= set("LRtsu")
