"""Steady states of the slow flow: none is missed, in three thousand drawn machines; which of them the ansatz covers."""

from __future__ import annotations

import numpy as np
import pytest

from orbits import multiple_scales as ms

pytestmark = pytest.mark.slow

KAPPA = 8 / np.pi**2


def drawn(seed, n=3_000):
    """Machines and detunings, as rows and as columns."""
    rng = np.random.default_rng(seed)
    highest = {"forcing": 5.0, "restitution": 1.0, "friction": 1.0, "gravity": 0.6, "damping": 3.0}
    least = {"forcing": 0.05, "restitution": 0.1, "gravity": 0.02}
    given = {name: rng.uniform(least.get(name, 0.0), high, n) for name, high in highest.items()}
    sigma = given["forcing"] * rng.uniform(-2, 2, n)
    columns = {name: values[:, None] for name, values in given.items()}
    return ms.SlowFlow(**given), sigma, ms.SlowFlow(**columns), sigma[:, None]


def balance(flow, b, sigma):
    """G C cos(gamma) and G C sin(gamma) that the two equations ask for, and C^2, written out anew."""
    R, h = (1 - flow.restitution) / (1 + flow.restitution), 0.5 * np.pi * flow.friction * flow.gravity
    reach, recoil = 1 - 0.5 * np.pi * b, R * b + h
    squared = reach**2 + recoil**2
    k1 = -4 / np.pi * b * recoil - KAPPA * h * reach
    k2 = 4 / np.pi * b * reach - KAPPA * h * recoil
    return k2 - 2 * sigma * squared, k1 - flow.damping * squared, squared


def test_every_equilibrium_of_three_thousand_machines_is_found():
    """A dense scan of the phase-free balance sees nothing that the roots miss, and every root balances the flow."""
    flow, sigma, wide, column = drawn(7)
    roots = ms.impacting_velocities(flow, sigma)
    cosine, sine, _ = balance(wide, roots, column)
    growth, turn = wide.rates(roots, np.arctan2(sine, cosine), column)
    good = np.isfinite(roots)
    assert np.max(np.abs(growth / (1 + roots**4))[good]) < 1e-9
    assert np.max(np.abs(turn[good])) < 1e-7
    top = np.maximum(np.max(np.where(good, roots, 0.0), axis=1) * 1.2, 4.0)
    b = np.linspace(0, 1, 1500) * top[:, None]
    cosine, sine, squared = balance(wide, b, column)
    gap = np.sign(cosine**2 + sine**2 - wide.forcing**2 * squared)
    seen = gap[:, :-1] != gap[:, 1:]
    assert np.all(seen.sum(axis=1) <= good.sum(axis=1))
    i, j = np.nonzero(seen)
    near = roots[i]
    assert np.all(((near >= b[i, j, None] - 1e-9) & (near <= b[i, j + 1, None] + 1e-9)).any(axis=1))
    assert good.sum() > 2_000  # the draw is not an empty one


def test_every_sliding_equilibrium_is_found():
    flow, sigma, wide, column = drawn(8)
    roots = ms.sliding_turning_points(flow, sigma)
    h = 0.5 * np.pi * wide.friction * wide.gravity
    delta = np.linspace(0, 1, 2000) * (1 - 2 * h / np.pi) + 2 * h / np.pi
    squared = delta**2 + h**2
    along, across = wide.damping * squared + KAPPA * h * delta, 2 * column * squared + KAPPA * h**2
    gap = along**2 + across**2 - wide.forcing**2 * squared
    seen = (gap[:, :-1] < 0) != (gap[:, 1:] < 0)
    assert np.array_equal(seen.sum(axis=1), np.isfinite(roots).sum(axis=1))
    i, j = np.nonzero(seen)
    assert np.all((roots[i, 0] >= delta[i, j] - 1e-12) & (roots[i, 0] <= delta[i, j + 1] + 1e-12))
    assert seen.sum() > 500


def test_states_solve_both_equations_and_say_whether_they_are_valid():
    """Valid where the absorber does not reverse: B - h - C > 0."""
    seen = set()
    for friction, forcing in ((0.0, 0.5), (0.0, 8.0), (0.5, 0.5), (0.5, 2.47), (0.5, 8.0)):
        flow = ms.SlowFlow(forcing=forcing, friction=friction)
        for detuning in np.linspace(-6.0, 6.0, 9).tolist():
            for state in ms.equilibria(flow, detuning):
                rates = flow.rates(state.position, state.phase, detuning, state.manifold)
                assert rates == pytest.approx((0.0, 0.0), abs=1e-9)
                if state.manifold == "impacting":
                    room = state.velocity - 0.5 * np.pi * friction * flow.gravity - state.amplitude
                    assert state.valid is bool(room > 0.0)
                    seen.add((friction, state.valid))
    assert len(seen) == 4
