"""Forces and energies at the contacts of a declared machine: of each impact, and what friction takes on a flight."""

from __future__ import annotations

import math

import numpy as np

from orbits.machines.page.machine import Machine

PLACES, WEIGHTS = np.polynomial.legendre.leggauss(16)
PIECE = 0.5 * math.pi  # of the clock: as much of a flight is integrated at once


class Impacts:
    """Impacts on one wall: arrays of speeds before them [m/s], the wall's restitution, and masses of the relative motion [kg]."""

    def __init__(
        self, machine: Machine, wall: int, after: np.ndarray, clocks: np.ndarray, params: np.ndarray
    ) -> None:
        """After impacts in states (m, n) at `clocks` (m,) with parameters (m, P); a page without energy has masses of 1."""
        numbers = np.hstack([params, np.zeros((len(params), len(machine.equations.signed)))])
        known = machine.equations.energy is not None
        rows = (machine.compiled.loads if known else machine.compiled.rebound)(wall)(after, clocks, numbers)
        self.speeds, self.restitution = rows[:, 0] / rows[:, 1], rows[:, 1]
        self.mass = rows[:, 2] if known else np.ones(len(rows))

    @property
    def impulses(self) -> np.ndarray:
        """(1 + r) m s [N s]."""
        return (1.0 + self.restitution) * self.mass * self.speeds

    @property
    def losses(self) -> np.ndarray:
        """Energy of the relative motion that each takes, (1 - r^2) m s^2/2 [J]."""
        return (1.0 - self.restitution**2) * (0.5 * self.mass * self.speeds**2)


def friction_work(
    machine: Machine, mode: tuple[int, ...], state: np.ndarray, begin: float, end: float, params: np.ndarray
) -> float:
    """Energy that frictions take on a flight [J], by Gauss-Legendre quadrature on pieces of it."""
    key = machine.equations.pattern_key(mode)
    if not end > begin:
        return 0.0
    pieces = math.ceil((end - begin) / PIECE)
    half = 0.5 * (end - begin) / pieces
    middles = begin + half * (2.0 * np.arange(pieces) + 1.0)
    clocks = (middles[:, None] + half * PLACES).ravel()
    numbers = machine.compiled.numbers(params, mode)
    states = machine.compiled.watch(key).path(state, np.concatenate([[begin], clocks]), numbers)[1:]
    power = machine.compiled.friction_power(key)(states, clocks, np.tile(numbers, (len(clocks), 1)))[:, 0]
    return float(power @ np.tile(WEIGHTS, pieces)) * half / float(machine.phase_speed(params))
