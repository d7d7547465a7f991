"""A measurement: oscillator, absorber and base in SI units by scipy's integrator, as somebody else would write it."""

import numpy as np
from scipy.integrate import solve_ivp

from tests.orbits.simulation.plain_integration import event

FREQUENCY, RATIO, MASS, ABSORBER, HALF_WIDTH, GRAVITY = 22.0, 0.005, 12.0, 0.15, 4e-3, 9.81
STUDY = """
units = "si"
[model]
name = "coupled"
oscillator_mass = "12 kg"
natural_frequency = "22 Hz"
damping_ratio = 0.005
absorber_mass = "150 g"
half_width = "4 mm"
restitution = 0.7
friction = 0.15
force_amplitude = "6 N"
[start]
word = "LR"
frequency = "21.8 Hz"
[continue]
parameter = "frequency"
within = ["20.5 Hz", "23.5 Hz"]
"""


def measurement(restitution, friction, first, base, end, most=10_000):
    """Impact times [s], instants and displacement [m] from the base, let go at `first` [m] under the base's acceleration `base(t)`."""
    k = MASS * (2.0 * np.pi * FREQUENCY) ** 2
    c, force = 2.0 * RATIO * np.sqrt(k * MASS), friction * ABSORBER * GRAVITY

    def push(y):
        return -k * y[0] - c * y[1]

    def need(t, y):
        return ABSORBER * push(y) / (MASS + ABSORBER)

    def released(y):
        """The way in which the absorber, as fast as the oscillator, slides; 0 if friction holds it."""
        mode = 0 if abs(need(0.0, y)) <= force else int(np.sign(need(0.0, y)))
        y[3] = y[1] - mode * 1e-10
        return mode

    t, y, hits, instants, places = 0.0, np.array([first, 0.0, first, 0.0]), [], [0.0], [first]
    mode = released(y)
    while t < end and len(hits) < most:

        def rates(t, y, S=mode):
            one, other = (push(y) - force * S) / MASS, force * S / ABSORBER
            if S == 0:
                one = other = push(y) / (MASS + ABSORBER)
            return [y[1], one - base(t), y[3], other - base(t)]

        events = [
            event(lambda t, y, S=mode: HALF_WIDTH - abs(y[0] - y[2]) if S else 1.0),
            event(lambda t, y, S=mode: S * (y[1] - y[3]) if S else force - abs(need(t, y))),
        ]
        run = solve_ivp(rates, (t, end), y, events=events, rtol=1e-9, atol=1e-13, max_step=2e-3)
        t, y = run.t[-1], run.y[:, -1].copy()
        instants += list(run.t)
        places += list(run.y[0])
        if run.status != 1:
            break
        if mode == 0:
            mode = int(np.sign(need(t, y)))
        elif run.t_events[0].size:
            hits.append(t)
            after, momentum = -restitution * (y[1] - y[3]), MASS * y[1] + ABSORBER * y[3]
            y[3] = (momentum - MASS * after) / (MASS + ABSORBER)
            y[1] = y[3] + after
            y[2] = y[0] - (1.0 - 1e-10) * HALF_WIDTH * np.sign(y[0] - y[2])
            mode = 1 if after > 0 else -1
        else:
            mode = released(y)
    return np.array(hits), np.array(instants), np.array(places)
