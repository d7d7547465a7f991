"""Independent solution of special points of cycles: multiple shooting by Taylor series (heyoka), Newton's method on an extended system.

    every cycle          x_(i+1) = flow over a part of the period from x_i, closed after the last part, a phase condition
    fold                 the parameter's component of the null vector of the derivative of these equations vanishes
    branch point         F(y) + b w = 0, A(y)^T w = 0, w.w = 1, A with one column more than rows (Moore 1980; b = 0 in the end)
    period doubling      an eigenvalue of the monodromy matrix is -1;  Neimark-Sacker: a pair has modulus 1
    symmetry breaking    half a period later the cycle is its mirror image: an eigenvalue of mirror times half the matrix is -1
                         (+1, in the directions that the mirror reverses, if every point of the cycle is its own mirror image)
    Hopf                 an equilibrium with a pair of eigenvalues of real part zero
    homoclinic           the unstable manifold of the saddle returns to it

No code of the package is used. Simulations include derivatives by state and parameter; the added condition is differentiated by finite
differences. Equilibria and homoclinic orbits are computed with scipy. If Newton's method does not converge, an error is raised.
"""

from __future__ import annotations

from typing import Any

import heyoka
import numpy as np
from scipy.integrate import solve_ivp

from ..demos.demo import NUMBERS

# radii of neighbourhoods of the saddle that a homoclinic orbit leaves and enters, relative to its size
NEARS = (0.1, 0.5)
LONG = 3e3  # longest time until it leaves or enters such a neighbourhood
GROWTH = 100.0  # largest growth of a perturbation in one part of a cycle, if more parts can avoid it
PARTS = (16, 32, 64)  # numbers of parts of a cycle that are tried
# last relative step of Newton's method: usual limit, and limit if rounding prevents smaller steps
CONVERGED, STALLED = (
    1e-11,
    1e-8,
)
BROKEN = 1e-7  # relative singular value below which a direction is ignored at a symmetry breaking
STEP = 1e-6  # relative step of finite differences of the forcing period
TOLERANCE = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}


def _taylor(equations: Any, free: bool, start: np.ndarray) -> Any:
    """Return an integrator of the states and of their derivatives by initial states and parameter."""
    x = [heyoka.expression(f"x{i}") for i in range(len(start))]
    p = heyoka.par[0]
    rates = equations(np.array(x), p, heyoka) if free else equations(np.array(x), p, heyoka.time, heyoka)
    varied = heyoka.var_ode_sys(list(zip(x, rates, strict=True)), args=[*x, p], order=1)
    return heyoka.taylor_adaptive(varied, list(start), compact_mode=True)


class Shooting:
    """Cycles of a demo by multiple shooting.

    Parameters
    ----------
    equations : callable
        (x, p, m) or (x, p, t, m) -> d numbers; m has the elementary functions.
    period : callable or None
        Forcing period as a function of p.
    edges : ndarray, shape (m + 1,)
        Limits of the parts, relative to the cycle (with ``turn``, to half of it): from 0 to 1.
    states : ndarray, shape (m, d)
        Guesses at the beginnings of the parts; the first fixes the phase.
    unit : ndarray, shape (d,)
        Sizes of the states' motions.
    clock : float
        Period.
    p : float
        Parameter.
    rounds : int
        Number of forcing periods.
    turn : ndarray, shape (d, d), optional
        Mirror by which the cycle is closed after half a period.
    """

    def __init__(
        self,
        equations: Any,
        period: Any,
        edges: np.ndarray,
        states: np.ndarray,
        unit: np.ndarray,
        clock: float,
        p: float,
        rounds: int = 1,
        turn: Any = None,
    ) -> None:
        self.period, self.edges, self.turn = period, edges, turn
        self.periods = rounds * (1.0 if turn is None else 0.5)  # until the cycle closes
        self.odd = np.eye(states.shape[1])  # basis (columns) of the directions whose multipliers are computed
        self.parts, self.d = states.shape
        self.free = period is None
        self.rates = lambda x, p, t: np.asarray(
            equations(x, p, NUMBERS) if self.free else equations(x, p, t, NUMBERS), dtype=float
        )
        self.taylor = _taylor(equations, self.free, states[0])
        self.first = states[0].copy()
        self.normal = self.rates(states[0], p, 0.0) if self.free else np.zeros(self.d)
        self.unit = np.maximum(unit, 1e-3 * unit.max())
        own = [clock] if self.free else []
        self.start = np.concatenate([states.reshape(-1), own, [p]])

    def part(self, x: np.ndarray, p: float, start: float, stop: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the state after a part (d,), and its derivatives by the initial state and the parameter (d, d + 1)."""
        taylor, d = self.taylor, self.d
        taylor.time, taylor.pars[0] = start, p
        taylor.state[:] = np.concatenate([x, np.eye(d, d + 1).reshape(-1)])
        if taylor.propagate_until(stop)[0] != heyoka.taylor_outcome.time_limit:
            raise ValueError(f"the simulation from t = {start:.6g} fails")
        return taylor.state[:d].copy(), taylor.state[d:].reshape(d, d + 1).copy()

    def cycle(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
        """Return the residuals of a cycle, their derivative by all unknowns, and the matrices of the parts."""
        m, d = self.parts, self.d
        states, p = y[: m * d].reshape(m, d), float(y[-1])
        times = self.edges * self.periods * (float(y[m * d]) if self.free else self.period(p))
        by = (
            self.edges * self.periods
        )  # derivative of the times by the period, which is unknown or depends on p
        by = (
            by
            if self.free
            else by * (self.period(p + STEP * p) - self.period(p - STEP * p)) / (2.0 * STEP * p)
        )
        n = m * d + self.free
        values, matrix, parts = np.zeros(n), np.zeros((n, n + 1)), []
        for i in range(m):
            end, jacobian = self.part(states[i], p, times[i], times[i + 1])
            before, after = self.rates(states[i], p, times[i]), self.rates(end, p, times[i + 1])
            moved = after * by[i + 1] - jacobian[:, :d] @ before * by[i]
            rows, closes = slice(i * d, (i + 1) * d), i == m - 1
            turn = (np.eye(d) if self.turn is None or not closes else self.turn) / self.unit[:, None]
            j = 0 if closes else i + 1
            values[rows] = turn @ end - states[j] / self.unit
            matrix[rows, i * d : (i + 1) * d] += turn @ jacobian[:, :d]
            matrix[rows, j * d : (j + 1) * d] -= np.diag(1.0 / self.unit)
            matrix[rows, -1] = turn @ jacobian[:, d]
            matrix[rows, m * d] += turn @ moved
            parts.append(self.unit[:, None] * turn @ jacobian[:, :d])
        if self.free:
            size = np.linalg.norm(self.normal * self.unit)
            values[-1] = self.normal @ (states[0] - self.first) / size
            matrix[-1, :d] = self.normal / size
        return values, matrix, parts

    def growth(self) -> float:
        """Largest growth of a perturbation in one part, relative to the sizes of the motions."""
        parts = self.cycle(self.start)[2]
        return max(float(np.linalg.norm(part * self.unit / self.unit[:, None], 2)) for part in parts)

    def monodromy(self, y: np.ndarray) -> np.ndarray:
        """Return the monodromy matrix of the period (with ``turn``, of half of it and the mirror)."""
        product = np.eye(self.d)
        for part in self.cycle(y)[2]:
            product = part @ product
        return product

    def multipliers(self, y: np.ndarray) -> np.ndarray:
        """Return the eigenvalues of the monodromy matrix in the directions `odd`."""
        return np.linalg.eigvals(self.odd.T @ self.monodromy(y) @ self.odd)


def eigenvalue_condition(shooting: Shooting, kind: str, at: complex) -> Any:
    """Return the condition of a special point: the eigenvalue nearest to ``at`` minus ``at``, or its modulus minus one."""

    def condition(y: np.ndarray) -> float:
        values = shooting.multipliers(y)
        nearest = values[int(np.argmin(np.abs(values - at)))]
        return abs(nearest) - 1.0 if kind == "neimark-sacker" else float(np.real(nearest - at))

    return condition


def newton(residual: Any, y: np.ndarray, scale: np.ndarray, least: float = 1e-14) -> np.ndarray:
    """Find a root by the chord method, with derivatives by differences that are updated every fourth step.

    Directions with singular values below ``least`` times the largest one are ignored.

    Raises
    ------
    ValueError
        If it does not converge.
    """
    matrix: Any = None
    size = np.inf
    for step in range(16):
        value = residual(y)
        if step % 4 == 0:
            steps = 1e-7 * np.diag(scale)
            matrix = np.column_stack([(residual(y + e) - value) / e.max() for e in steps])
        change = np.linalg.lstsq(matrix * scale, -value, rcond=least)[0] * scale
        y = y + change
        size = float(np.abs(change / scale).max())
        if size < CONVERGED:
            return y
    if not size < STALLED:
        raise ValueError(f"Newton's method does not converge: its last step is {size:.1e}")
    return y


def solve(kind: str, shooting: Shooting, multiplier: complex = -1.0) -> np.ndarray:
    """Solve for a special point; return its unknowns: states, period, parameter."""
    y = shooting.start.copy()
    m, d = shooting.parts, shooting.d
    scale = np.concatenate([np.tile(shooting.unit, m), np.abs(y[m * d :]) + 1e-3])
    if kind in ("fold", "branch-point"):
        n = len(y) - 1
        if kind == "fold":

            def residual(z: np.ndarray) -> np.ndarray:
                values, matrix = shooting.cycle(z)[:2]
                null = np.linalg.svd(matrix * scale)[2][-1]
                return np.append(values, null[-1] * np.sign(null @ reference))

            reference = np.linalg.svd(shooting.cycle(y)[:2][1] * scale)[2][-1]
            return newton(residual, y, scale)
        left = np.linalg.svd(shooting.cycle(y)[:2][1] * scale)[0][:, -1]

        def moore(z: np.ndarray) -> np.ndarray:
            point, w, b = z[: n + 1], z[n + 1 : -1], z[-1]
            values, matrix = shooting.cycle(point)[:2]
            return np.concatenate([values + b * w, (matrix * scale).T @ w, [w @ w - 1.0]])

        full = newton(moore, np.concatenate([y, left, [0.0]]), np.concatenate([scale, np.ones(n), [1.0]]))
        return full[: n + 1]
    condition = eigenvalue_condition(shooting, kind, multiplier)

    def both(z: np.ndarray) -> np.ndarray:
        return np.append(shooting.cycle(z)[0], condition(z))

    # if every point of the cycle is its own mirror image, the direction that breaks the symmetry is a null vector here
    alike = kind == "symmetry-breaking" and shooting.turn is None
    return newton(both, y, scale, BROKEN if alike else 1e-14)


def hopf(rates: Any, u: np.ndarray, p: float) -> tuple[np.ndarray, float]:
    """Solve for an equilibrium with eigenvalues of real part zero; return state and parameter."""
    d = len(u)

    def residual(z: np.ndarray) -> np.ndarray:
        steps = z[:d] + 1e-30j * np.eye(d)
        matrix = np.array([np.imag(rates(s, z[d])) for s in steps]).T / 1e-30
        values = np.linalg.eigvals(matrix)
        pair = values[np.abs(values.imag) > 1e-9]
        return np.append(rates(z[:d], z[d]), pair[int(np.argmin(np.abs(pair.real)))].real)

    z = newton(residual, np.append(u, p), np.append(np.abs(u) + 1e-3, abs(p) + 1e-3))
    return z[:d], float(z[d])


def fold_of_equilibria(rates: Any, u: np.ndarray, p: float) -> tuple[np.ndarray, float]:
    """Solve for an equilibrium with a singular Jacobian; return state and parameter."""
    d = len(u)

    def residual(z: np.ndarray) -> np.ndarray:
        steps = z[:d] + 1e-30j * np.eye(d)
        return np.append(
            rates(z[:d], z[d]), np.linalg.det(np.array([np.imag(rates(s, z[d])) for s in steps])) / 1e-30**d
        )

    z = newton(residual, np.append(u, p), np.append(np.abs(u) + 1e-3, abs(p) + 1e-3))
    return z[:d], float(z[d])


class Homoclinic:
    """Homoclinic orbit: the one-dimensional manifold of a saddle returns to it, forwards in time or (if it is the stable manifold) backwards.

    Parameters
    ----------
    rates : callable
        (x, p) -> rates.
    states : ndarray, shape (n, d)
        States of a nearby cycle in order of time; the first has the lowest speed.
    """

    def __init__(self, rates: Any, states: np.ndarray) -> None:
        self.rates, self.states = rates, states
        self.size = float(np.ptp(states, axis=0).max())

    def saddle(self, p: float, sign: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
        """Return the saddle, the direction of its one-dimensional manifold, the normal of the other manifold, and the number of unstable eigenvalues."""
        x, d = self.states[0], self.states.shape[1]
        for _ in range(30):
            steps = x + 1e-30j * np.eye(d)
            matrix = np.array([np.imag(self.rates(s, p)) for s in steps]).T / 1e-30
            change = np.linalg.solve(matrix, -np.asarray(self.rates(x, p), dtype=float))
            x = x + change
            if np.abs(change).max() < 1e-14 * self.size:
                break
        values, vectors = np.linalg.eig(sign * matrix)
        k = int(np.argmax(values.real))
        left = np.linalg.eig(sign * matrix.T)
        normal = np.real(left[1][:, int(np.argmax(left[0].real))])
        return x, np.real(vectors[:, k]), normal, int((values.real > 0.0).sum())

    def passes(self, p: float, sign: float, near: float) -> float:
        """Return on which side of the other manifold (+1 or -1) the one-dimensional manifold passes the saddle on its return; 0 if it does not return.

        `sign` is the direction of time, 1 or -1.
        """
        x, direction, normal, _ = self.saddle(p, sign)
        states = self.states if sign > 0.0 else np.roll(self.states[::-1], 1, axis=0)
        gone = states[int(np.argmax(np.linalg.norm(states - x, axis=1) > near * self.size))] - x
        lead = direction * np.sign((normal @ direction) * (normal @ gone))
        start = x + 1e-7 * self.size * lead / np.linalg.norm(lead)

        def rate(t: float, y: np.ndarray) -> Any:
            return sign * np.asarray(self.rates(y, p), dtype=float)

        def leaves(t: float, y: np.ndarray) -> float:
            return float(np.linalg.norm(y - x)) - near * self.size

        def comes(t: float, y: np.ndarray) -> float:
            return leaves(t, y)

        leaves.terminal, leaves.direction = True, 1.0  # type: ignore[attr-defined]
        comes.terminal, comes.direction = True, -1.0  # type: ignore[attr-defined]
        y = start
        for event in (leaves, comes, leaves):
            found = solve_ivp(rate, (0.0, LONG), y, events=event, **TOLERANCE)
            if not found.t_events[0].size:
                return 0.0
            y = found.y[:, -1]
        return float(np.sign((normal @ lead) * (normal @ (y - x))))

    def solve(self, p: float, width: float) -> float:
        """Return the parameter by bisection on the result of `passes`."""
        _, _, _, unstable = self.saddle(p, 1.0)
        sign = 1.0 if unstable == 1 else -1.0
        for near in NEARS:
            low, high = p - width, p + width
            first = self.passes(low, sign, near)
            if first != self.passes(high, sign, near):
                break
        else:
            raise ValueError("no homoclinic orbit between these values")
        for _ in range(60):
            middle = 0.5 * (low + high)
            if middle in (low, high):
                break
            if self.passes(middle, sign, near) == first:
                low = middle
            else:
                high = middle
        return 0.5 * (low + high)
