"""A measurement: oscillator, absorber and base in SI units by scipy's integrator, as somebody else would write it."""

import numpy as np
from scipy.integrate import solve_ivp

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

    def need(y):
        return ABSORBER * (-k * y[0] - c * y[1]) / (MASS + ABSORBER)

    t, y, hits, instants, places = 0.0, np.array([first, 0.0, first, 0.0]), [], [0.0], [first]
    mode = 0 if abs(need(y)) <= force else int(np.sign(need(y)))
    y[3] -= mode * 1e-10
    while t < end and len(hits) < most:

        def rates(t, y, S=mode):
            push = -k * y[0] - c * y[1]
            if S == 0:
                a = push / (MASS + ABSORBER) - base(t)
                return [y[1], a, y[1], a]
            return [y[1], (push - force * S) / MASS - base(t), y[3], force * S / ABSORBER - base(t)]

        if mode == 0:
            events = [lambda t, y: force - need(y), lambda t, y: force + need(y)]
        else:
            events = [
                lambda t, y: HALF_WIDTH - (y[0] - y[2]),
                lambda t, y: HALF_WIDTH + (y[0] - y[2]),
                lambda t, y, S=mode: S * (y[1] - y[3]),
            ]
        for event in events:
            event.terminal, event.direction = True, -1
        run = solve_ivp(rates, (t, end), y, events=events, rtol=1e-9, atol=1e-13, max_step=2e-3)
        t, y = run.t[-1], run.y[:, -1].copy()
        instants += list(run.t)
        places += list(run.y[0])
        if run.status != 1:
            break
        which = next(i for i, found in enumerate(run.t_events) if len(found))
        if mode == 0:
            mode = 1 if which == 0 else -1
        elif which < 2:
            hits.append(t)
            after, momentum = -restitution * (y[1] - y[3]), MASS * y[1] + ABSORBER * y[3]
            y[3] = (momentum - MASS * after) / (MASS + ABSORBER)
            y[1] = y[3] + after
            y[2] = y[0] - (1.0 - 1e-10) * HALF_WIDTH * (1 if which == 0 else -1)
            mode = 1 if after > 0 else -1
        else:
            y[3] = y[1]
            mode = 0 if abs(need(y)) <= force else int(np.sign(need(y)))
            y[3] -= mode * 1e-10
    return np.array(hits), np.array(instants), np.array(places)
