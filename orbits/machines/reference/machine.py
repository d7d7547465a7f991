"""The kernels of one built-in machine in Python and numpy: maps of its cycles, and the stepper (:mod:`orbits.machines.stepping`)."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.machines.reference import maps, margins
from orbits.machines.reference.law import DRIVEN, LAWS, Law
from orbits.machines.reference.oscillation import after, oscillation, standing
from orbits.machines.reference.stepper import Run, launch
from orbits.machines.stepping import FAILED, LOW, MODE, PSI, RATE, V_RATE, Stepper, V, W

if TYPE_CHECKING:
    from orbits.arguments import CycleData, Workspace

NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)


class Reference(Stepper):
    """Maps, margins and stepper of the machine called `name`."""

    def __init__(self, name: str) -> None:
        super().__init__(name, name in DRIVEN)
        self.law_of = LAWS[name]

    def __reduce__(self) -> tuple[Any, ...]:
        return reference, (self.name,)

    def law(self, params: np.ndarray) -> Law:
        """Return the numbers of the equations of motion."""
        with np.errstate(all="ignore"):
            return self.law_of([*np.asarray(params, dtype=float)])

    # ------------------------------------------------------------------ cycles
    def linearise(self, data: CycleData, u: np.ndarray, p: float, work: Workspace) -> float:
        """Write residuals and derivatives at the cycle `u`; see `orbits.machines.reference.maps.linearise`."""
        return maps.linearise(self.law_of, data, u, p, work)

    def margins(self, data: CycleData, u: np.ndarray, work: Workspace, out: np.ndarray) -> None:
        """Write margins of admissibility, four numbers per node, from the last `linearise`."""
        margins.margins(self.law(work.numbers), data, u, work, out)

    # ------------------------------------------------------------------ simulation
    def walls(self, params: np.ndarray) -> tuple[float, float]:
        law = self.law(params)
        return law.left, law.right

    @np.errstate(all="ignore")
    def launch(self, state: np.ndarray, params: np.ndarray) -> None:
        launch(self.law(params), state)

    @np.errstate(all="ignore")
    def advance(
        self,
        state: np.ndarray,
        params: np.ndarray,
        until: float,
        codes: np.ndarray,
        modes: np.ndarray,
        rows: np.ndarray,
    ) -> tuple[int, int]:
        try:
            return Run(state, self.law(params)).advance(until, codes, modes, rows)
        except (OverflowError, ValueError):  # from numbers that are no longer finite
            return 0, FAILED

    @np.errstate(all="ignore")
    def sample(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        law = self.law(params)
        for state, phase, row in zip(states, ahead, out):
            q, tau = oscillation(state, law), phase / law.omega
            row[:] = after(law, q, q.at(tau), standing(state, law), state[MODE], tau, state[LOW])

    @np.errstate(all="ignore")
    def works(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """Write works of excitation, damper and friction in pieces of flights; item 5 of `orbits.machines.stepping`.

        On an oscillator, per M b^2 omega_0^2: the integrals of (e + eps lambda e') q1' and of eps lambda q1'^2, and eps mu g times the sliding
        distance. In a shaken cavity, in its own frame and per mass of the absorber: the integral of v'' w', no damper, and the friction's acceleration
        times the sliding distance.
        """
        law = self.law(params)
        eps, omega = law.eps, law.omega
        for state, phase, row in zip(states, ahead, out):
            q, span = oscillation(state, law), phase / omega
            times, weights = quadrature(phase, span)
            points = [q.at(tau) for tau in times]
            rate = q.h1 + q.z1 + np.array([at.speed for at in points])
            sliding, Psi = state[MODE] != 0.0, state[PSI] + omega * times
            if law.prescribed:
                relative = rate - (q.q2_rate + q.q2_pull * times) if sliding else 0.0 * rate
                row[0], row[1] = (weights * np.array([at.h2 for at in points])) @ relative, 0.0
            else:
                row[0] = law.force * (weights * rate) @ (np.sin(Psi) + law.base * np.cos(Psi))
                row[1] = law.drag * weights @ rate**2
            slid = q.at(span).way - q.travel(span) if sliding else 0.0
            friction = law.side(state[MODE]).friction / law.whole
            row[2] = (1.0 if law.prescribed else eps) * friction * abs(slid)

    def energies(self, states: np.ndarray, params: np.ndarray, out: np.ndarray) -> None:
        """Write energies of states; item 5 of `orbits.machines.stepping`.

        On an oscillator kinetic and potential energy per M b^2 omega_0^2, (q1'^2 + q1^2 + eps q2'^2)/2 + eps g sin(slope) w; in a shaken cavity that of
        the relative motion per mass of the absorber, w'^2/2 + b w.
        """
        law = self.law(params)
        eps, lean, whole = law.eps, law.lean, law.whole
        if law.prescribed:
            out[:] = 0.5 * states[:, RATE] ** 2 + lean * states[:, W]
            return
        q1 = (states[:, V] + eps * states[:, W]) / whole
        q1_rate = (states[:, V_RATE] + eps * states[:, RATE]) / whole
        q2_rate = (states[:, V_RATE] - states[:, RATE]) / whole
        out[:] = 0.5 * (q1_rate**2 + q1**2 + eps * q2_rate**2) + eps * lean * states[:, W]

    @np.errstate(all="ignore")
    def shapes(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        law = self.law(params)
        eps, omega = law.eps, law.omega
        for state, length, row in zip(states, ahead, out):
            q, span = oscillation(state, law), length / omega
            q1 = (state[V] + eps * state[W]) / law.whole
            times, weights = quadrature(length, span)
            way = np.array([q.at(tau).way for tau in times])
            travel = (q.q2_rate + 0.5 * q.q2_pull * times) * times
            v = state[V] + (way + eps * travel if state[MODE] != 0.0 else law.whole * way)
            Psi = state[PSI] + omega * times
            row[0] = max(abs(q1 + q.at(tau).way) for tau in (0.0, *q.zeros(1, 0.0, span), span))
            row[1] = omega * (weights * v) @ np.sin(Psi)
            row[2] = omega * (weights * v) @ np.cos(Psi)
            row[3] = omega * (weights * (q1 + way)) @ np.sin(Psi)


@cache
def reference(name: str) -> Reference:
    """Return the reference of the machine called `name`, made once."""
    return Reference(name)


def quadrature(phase: float, span: float) -> tuple[np.ndarray, np.ndarray]:
    """Return instants and weights of an integral over a span of time, in which the phase of the forcing grows by `phase`.

    The integrands are sums of exponentials. The 16-point Gauss rule on pieces of at most one turn has an error below 1e-19 for a product of
    two waves, cos 2 x.
    """
    pieces = int(max(phase, span) / (2.0 * math.pi)) + 1
    half = 0.5 * span / pieces
    middles = (2.0 * np.arange(pieces) + 1.0) * half
    return (middles[:, None] + half * NODES).ravel(), np.tile(half * WEIGHTS, pieces)
