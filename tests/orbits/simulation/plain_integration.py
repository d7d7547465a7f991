"""The absorber in its shaken cavity by scipy's integrator with events; it knows nothing of the package."""

import numpy as np
from scipy.integrate import solve_ivp

from tests.orbits.machines.coupled.equations_of_motion import TIGHT


def event(function):
    """`function` as an event of solve_ivp that ends the run where it falls to zero."""
    function.terminal, function.direction = True, -1
    return function


def events_of(amplitude, omega, pull, frictions, walls, restitutions, start, count):
    """The first events (letter, phase, w, w' after) of w'' = -C Omega^2 sin Psi - b - s a_s from (phase, w, w').

    Frictions, places of the walls and restitutions are given by the direction of motion, 1 and -1.
    """
    first, w, rate = start
    t, events = 0.0, []

    def push(t):
        return -amplitude * omega**2 * np.sin(first + omega * t) - pull

    def reserve(s):
        return event(lambda t, y: frictions[s] - s * push(t))

    def way_from_rest():
        return next((s for s in (1, -1) if reserve(s)(t, None) < -1e-12), 0)

    mode = int(np.sign(rate)) or way_from_rest()
    while len(events) < count:

        def rates(t, y, s=mode):
            return y[1], push(t) - s * frictions[s] if s else 0.0

        wall = event(lambda t, y, s=mode: s * (walls[s] - y[0]))
        stops = event(lambda t, y, s=mode: s * y[1])
        watch = (wall, stops) if mode else (reserve(1), reserve(-1))
        run = solve_ivp(rates, (t, t + 60.0), (w, rate), events=watch, max_step=0.1, **TIGHT)
        t, (w, rate) = run.t[-1], run.y[:, -1]
        if mode == 0:
            letter, mode = "u", 1 if run.t_events[0].size else -1
        elif run.t_events[0].size:
            w, rate = walls[mode], -restitutions[mode] * rate
            letter, mode = "L" if mode > 0 else "R", -mode
        else:
            rate, before = 0.0, mode
            mode = way_from_rest()
            letter = "t" if mode == -before else "s"
        events.append((letter, first + omega * t, w, rate))
    return events
