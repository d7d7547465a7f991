"""Steady states of the slow flow: none is missed, in three thousand drawn machines."""

from __future__ import annotations

import numpy as np
import pytest

from orbits import multiple_scales as ms

pytestmark = pytest.mark.slow


def drawn_flows(n, seed):
    rng = np.random.default_rng(seed)
    flow = ms.SlowFlow(
        forcing=rng.uniform(0.05, 5, n), restitution=rng.uniform(0.1, 1, n), friction=rng.uniform(0, 1, n),
        gravity=rng.uniform(0.02, 0.6, n), damping=rng.uniform(0, 3, n),
    )  # fmt: skip
    return flow, flow.forcing * rng.uniform(-2, 2, n)


def test_every_equilibrium_of_three_thousand_machines_is_found():
    """A dense scan of the phase-free balance sees nothing that the roots miss, and every root balances
    the flow."""
    n, grid = 3_000, 1500
    flow, sigma = drawn_flows(n, 7)
    roots = ms.impacting_velocities(flow, sigma)
    phase = np.arctan2(*reversed(balance(flow, roots, sigma)))
    growth, turn = wide(flow).rates(roots, phase, sigma[:, None])
    good = np.isfinite(roots)
    size = 1 + roots**4
    assert np.max(np.abs(growth[good] / size[good])) < 1e-9
    assert np.max(np.abs(turn[good])) < 1e-7
    missed = 0
    for start in range(0, n, 1000):
        part = slice(start, start + 1000)
        top = np.maximum(np.nanmax(np.where(good[part], roots[part], 0.0), axis=1) * 1.2, 4.0)
        b = np.linspace(0, 1, grid)[None, :] * top[:, None]
        some = pick(flow, part)
        g_c, g_s = balance(some, b, sigma[part])
        squared = wide(some).harmonics(b)[0]
        gap = g_c**2 + g_s**2 - wide(some).forcing ** 2 * squared
        seen = np.sign(gap[:, :-1]) != np.sign(gap[:, 1:])
        for i, j in zip(*np.nonzero(seen)):
            inside = (roots[part][i] >= b[i, j] - 1e-9) & (roots[part][i] <= b[i, j + 1] + 1e-9)
            missed += not inside.any()
        assert np.all(seen.sum(axis=1) <= good[part].sum(axis=1))
    assert missed == 0
    assert good.sum() > 2_000  # the draw is not an empty one


def wide(flow):
    fields = ("forcing", "restitution", "friction", "gravity", "damping")
    return flow.with_(**{k: getattr(flow, k)[:, None] for k in fields})


def pick(flow, part):
    fields = ("forcing", "restitution", "friction", "gravity", "damping")
    return flow.with_(**{k: getattr(flow, k)[part] for k in fields})


def balance(flow, b, sigma):
    """G C cos(gamma) and G C sin(gamma) that the two equations ask for, written out anew."""
    w = wide(flow)
    R, h, kappa = (
        (1 - w.restitution) / (1 + w.restitution),
        0.5 * np.pi * w.friction * w.gravity,
        8 / np.pi**2,
    )
    squared = (1 - 0.5 * np.pi * b) ** 2 + (R * b + h) ** 2
    k1 = -4 / np.pi * b * (R * b + h) - kappa * h * (1 - 0.5 * np.pi * b)
    k2 = 4 / np.pi * b * (1 - 0.5 * np.pi * b) - kappa * h * (R * b + h)
    return k2 - 2 * sigma[:, None] * squared, k1 - w.damping * squared


def test_every_sliding_equilibrium_is_found():
    flow, sigma = drawn_flows(3_000, 8)
    roots = ms.sliding_turning_points(flow, sigma)
    h, kappa = 0.5 * np.pi * flow.friction * flow.gravity, 8 / np.pi**2
    delta = np.linspace(0, 1, 2000)[None, :] * (1 - 2 * h / np.pi)[:, None] + (2 * h / np.pi)[:, None]
    squared = delta**2 + h[:, None] ** 2
    gap = (
        (flow.damping[:, None] * squared + kappa * h[:, None] * delta) ** 2
        + (2 * sigma[:, None] * squared + kappa * h[:, None] ** 2) ** 2
        - flow.forcing[:, None] ** 2 * squared
    )
    seen = (gap[:, :-1] < 0) != (gap[:, 1:] < 0)
    assert np.array_equal(seen.sum(axis=1), np.isfinite(roots).sum(axis=1))
    where = np.nonzero(seen)
    assert np.all(
        (roots[where[0], 0] >= delta[where] - 1e-12)
        & (roots[where[0], 0] <= delta[where[0], where[1] + 1] + 1e-12)
    )
    assert seen.sum() > 500
