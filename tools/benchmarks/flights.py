"""Time of simulation per impact: the package, a plain C program, and scipy's solve_ivp with events, from the same start."""

import ctypes

import numpy as np
from scipy.integrate import solve_ivp

from orbits import Absorber
from orbits.flows.native.simulator import first_state
from orbits.machines.coupled import Coupled
from orbits.machines.native_stepper import stepper as machine
from orbits.machines.stepping import buffers

from .floor import PLAIN, library

MODELS = {
    "absorber": (
        Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006),
        {"amplitude": 0.55},
    ),
    "coupled": (
        Coupled(
            restitution=0.76,
            friction=0.5,
            gravity=0.211,
            mass_ratio=0.006,
            damping=0.9,
            frequency=1.0 - 2.58 * 0.006,
        ),
        {"forcing": 2.47},
    ),
}
SETTLE = 5000


class Flights:
    """An attractor with impacts of one model; each method computes the next `count` impacts from the same one."""

    def __init__(self, name):
        self.model, extra = MODELS[name]
        self.name, self.params, self.engine = name, self.model.vector(extra), machine(name)
        start = {"q1": 1.0, "q2": 1.0} if name == "coupled" else None
        self.state = first_state(self.model, self.engine, self.params, start)
        self.advance(SETTLE)
        codes, _, rows = self.advance(1)
        while codes[0] > 1:
            codes, _, rows = self.advance(1)
        psi, _, w, _, rate = rows[0, :5]
        self.start = np.array([psi, w, rate, *(rows[0, 5:7] if name == "coupled" else ())])

    def advance(self, count, state=None):
        """Return events of the package's simulator: codes, modes, rows."""
        out = buffers(self.engine, count)
        self.engine.advance(self.state if state is None else state, self.params, np.inf, *out)
        return out

    def ours(self, count):
        """Return phases (relative to the start) and speeds before the impacts, by the package."""
        rows = self.advance(count, self.state.copy())[2]
        return rows[:, 0] + 2.0 * np.pi * (rows[:, 1] - self.state[4]), rows[:, 3]

    def floor(self, count):
        """Return the same by the C program; None without a compiler."""
        code = library("simulation.c", PLAIN)
        if code is None:
            return None
        function = code.floor_reduced if self.name == "absorber" else code.floor_coupled
        number = ctypes.POINTER(ctypes.c_double)
        function.argtypes, function.restype = [number, number, ctypes.c_int, number], ctypes.c_int
        rows, start = np.empty((count, 3)), self.start.copy()
        made = function(
            *(x.ctypes.data_as(number) for x in (self.params, start)), count, rows.ctypes.data_as(number)
        )
        return rows[:made, 0], rows[:made, 1]

    def solve_ivp(self, count, method="DOP853", tolerance=1e-9):
        """Return the same by scipy, one flight at a time with walls as terminal events."""
        flight = _reduced if self.name == "absorber" else _coupled
        restitution = self.params[1] if self.name == "absorber" else self.params[4]
        omega = self.params[5] if self.name == "absorber" else self.params[1]
        time, y = 0.0, self.start[1:].copy()
        phases, speeds = [], []
        for _ in range(count):
            s = np.sign(y[1])

            def wall(t, y, s=s):
                return y[0] - s

            wall.terminal, wall.direction = True, s
            found = solve_ivp(
                lambda t, y, s=s: flight(t, y, s, self.params, self.start[0]),
                (time, time + 100.0),
                y,
                method,
                events=wall,
                rtol=tolerance,
                atol=tolerance,
            )
            time, y = found.t_events[0][0], found.y_events[0][0].copy()
            phases.append(self.start[0] + omega * time)
            speeds.append(y[1])
            y[0] = s
            y[1] *= -restitution
        return np.array(phases), np.array(speeds)


def _reduced(t, y, s, params, phase):
    amplitude, _, friction, gravity, mass_ratio, omega = params
    a = (1.0 + mass_ratio) * friction * gravity
    return [y[1], -amplitude * omega**2 * np.sin(phase + omega * t) - a * s]


def _coupled(t, y, s, params, phase):
    forcing, omega, damping, eps, _, friction, gravity, excitation, _ = params  # on level ground
    psi = phase + omega * t
    rub = friction * gravity * s
    w, w_rate, v, v_rate = y
    q1, q1_rate = (v + eps * w) / (1.0 + eps), (v_rate + eps * w_rate) / (1.0 + eps)
    e = eps * forcing * (np.sin(psi) + excitation * eps * damping * omega * np.cos(psi))
    q1_acc = e - eps * damping * q1_rate - q1 - eps * rub
    return [w_rate, q1_acc - rub, v_rate, q1_acc + eps * rub]
