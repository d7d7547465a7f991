"""The absorber in its shaken cavity by scipy's integrator with events; it knows nothing of the package."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def events_of(amplitude, omega, pull, frictions, walls, restitutions, start, count):
    """The first events (letter, phase, w, w' after) of w'' = -C Omega^2 sin Psi - b - s a_s from (phase, w, w').

    Frictions, places of the walls and restitutions are given by the direction of motion, 1 and -1.
    """
    psi, w, rate = start
    events = []

    def push(phase):
        return -amplitude * omega**2 * np.sin(phase) - pull

    def reserve(s, phase):
        return frictions[s] - s * push(phase)

    def way_from_rest():
        return next((s for s in (1, -1) if reserve(s, psi) < -1e-12), 0)

    mode = int(np.sign(rate)) or way_from_rest()
    while len(events) < count:
        if mode == 0:
            grid = psi + np.linspace(0.0, 2.0 * np.pi, 4001)
            gives = {
                s: np.flatnonzero((reserve(s, grid)[1:] < 0.0) & (reserve(s, grid)[:-1] >= 0.0))
                for s in (1, -1)
            }
            mode = min((s for s in gives if gives[s].size), key=lambda s: gives[s][0])
            i = gives[mode][0]
            psi = brentq(lambda x, s=mode: reserve(s, x), grid[i], grid[i + 1], xtol=1e-15)
            events.append(("u", psi, w, 0.0))
            continue

        def motion(tau, y, s=mode, begin=psi):
            return y[1], push(begin + omega * tau) - s * frictions[s]

        def stops(tau, y, s=mode):
            return s * y[1] if tau > 1e-6 else 1.0

        def wall(tau, y, s=mode):
            return s * (walls[s] - y[0])

        stops.terminal = wall.terminal = True
        stops.direction = wall.direction = -1
        options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14, "max_step": 0.1}
        run = solve_ivp(motion, (0.0, 60.0), (w, rate), events=(stops, wall), **options)
        psi, (w, rate) = psi + omega * run.t[-1], run.y[:, -1]
        if run.t_events[1].size:
            w, rate = walls[mode], -restitutions[mode] * rate
            letter, mode = "L" if mode > 0 else "R", -mode
        else:
            rate, before = 0.0, mode
            mode = way_from_rest()
            letter = "t" if mode == -before else "s"
        events.append((letter, psi, w, rate))
    return events
