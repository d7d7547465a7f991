"""The slow flow against quadrature, direct flight, finite differences and dense scans: nothing of itself."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from orbits import multiple_scales as ms

restitutions = st.floats(0.2, 0.99)


def triangle(z):
    return np.arcsin(np.sin(z))


def ripple(z, friction_acceleration):
    """The friction's part of the absorber's motion, for unit mu g times the given acceleration."""
    return -0.5 * friction_acceleration * (triangle(z) ** 2 - 0.25 * np.pi**2) * np.sign(np.cos(z))


def projected(function, wave):
    edges = (0.0, 0.5 * np.pi, 1.5 * np.pi, 2.0 * np.pi)
    pieces = (quad(lambda z: function(z) * wave(z), a, b, epsabs=1e-13)[0] for a, b in pairwise(edges))
    return sum(pieces) / np.pi


def test_the_paper_s_kappa_is_the_printed_one():
    assert ms.CLOSURES["paper"] == pytest.approx((np.pi**4 - 16) / np.pi**4, rel=1e-15)


@settings(max_examples=25, deadline=None)
@given(b=st.floats(0.05, 2.5), r=restitutions, mu=st.floats(0.0, 1.0), g=st.floats(0.05, 0.6))
def test_harmonics_are_projections_of_the_absorbers_motion(b, r, mu, g):
    """k1 = -C (4/pi B sin + kappa h cos) etc. from the harmonics of Phi = B Pi + ripple at phase eta -
    theta."""
    flow = ms.SlowFlow(restitution=r, friction=mu, gravity=g)
    motion = lambda z: b * triangle(z) + ripple(z, mu * g)  # noqa: E731
    sine, cosine = projected(motion, np.sin), projected(motion, np.cos)
    R, h = (1 - r) / (1 + r), 0.5 * np.pi * mu * g
    reach, recoil = 1 - 0.5 * np.pi * b, R * b + h  # C cos(eta - theta), C sin(eta - theta)
    squared, k1, k2 = flow.harmonics(b)
    assert k1 == pytest.approx(-(sine * recoil + cosine * reach), abs=1e-11)
    assert k2 == pytest.approx(sine * reach - cosine * recoil, abs=1e-11)
    assert squared == pytest.approx(reach**2 + recoil**2, rel=1e-14)


def half_map(state, amplitude, friction_acceleration, r):
    """Half a period of the symmetric motion followed by the mirror: phase and rate after an impact at L -> at L."""
    phase, rate = state

    def w(x):
        d = x - phase
        slope = rate - amplitude * np.cos(phase)
        return 2.0 + amplitude * (np.sin(x) - np.sin(phase)) + slope * d + 0.5 * friction_acceleration * d**2

    hit = phase + 0.3
    while w(hit) > 0:
        hit += 0.05
    hit = brentq(w, hit - 0.3, hit, xtol=1e-15)
    speed = rate + amplitude * (np.cos(hit) - np.cos(phase)) + friction_acceleration * (hit - phase)
    return np.array([hit - np.pi, r * speed])


def half_multipliers(b, r, h):
    """A point of the slow manifold, its image, and the multipliers there."""
    R = (1 - r) / (1 + r)
    amplitude = float(np.sqrt(ms.squared_amplitude(b, R, h)))
    phase = np.arctan2(1 - 0.5 * np.pi * b, R * b + h)
    x = np.array([phase, amplitude * np.cos(phase) - (b + h)])  # B+ = B + h
    flown = lambda x: half_map(x, amplitude, h / (0.5 * np.pi), r)  # noqa: E731
    columns = [(flown(x + e) - flown(x - e)) / 2e-5 for e in 1e-5 * np.eye(2)]
    return x, flown(x), np.linalg.eigvals(np.array(columns).T)


@settings(max_examples=25, deadline=None)
@given(r=st.floats(0.4, 0.95), h=st.floats(0.0, 0.3), place=st.floats(0.05, 0.95))
def test_manifold_is_the_symmetric_orbit_of_a_shaken_cavity(r, h, place):
    """At eps = 0 the slow manifold is exact: fly half a period and arrive at the mirror image.

    The half map followed by the mirror has multiplier +1 at the lower end of the attracting part (fold), -1 at the upper one.
    """
    R = (1 - r) / (1 + r)
    low, high = ms.activation(R, h).velocity, ms.symmetry_limit(R, h).velocity
    x, image, multipliers = half_multipliers(low + place * (high - low), r, h)
    assert image == pytest.approx(x, abs=1e-9)
    assert np.all(np.abs(multipliers) < 1 + 1e-6)
    for velocity, critical in ((low, 1), (high, -1)):
        assert np.min(np.abs(half_multipliers(velocity, r, h)[2] - critical)) < 1e-5


@settings(max_examples=15, deadline=None)
@given(r=restitutions, mu=st.floats(0, 1), lam=st.floats(0.05, 2), start=st.floats(0.7, 3))
def test_free_decay_in_closed_form_is_the_integrated_flow(r, mu, lam, start):
    flow = ms.SlowFlow(forcing=0.0, restitution=r, friction=mu, damping=lam)
    low = float(flow.activation.amplitude)
    assume(start >= low + 0.05)
    times = np.linspace(0, 0.9 * ms.decay_time(flow, start), 7)
    R, h = (1 - r) / (1 + r), 0.5 * np.pi * mu * 0.211
    lowest = (2 * np.pi - 4 * R * h) / (np.pi**2 + 4 * R**2)

    def rate(_t, s):
        b = lowest + np.sqrt(np.maximum(s - low**2, 0.0) / (np.pi**2 / 4 + R**2))
        return -lam * s - 4 / np.pi * b * (R * b + h) - 8 / np.pi**2 * h * (1 - 0.5 * np.pi * b)

    run = solve_ivp(rate, (0, times[-1]), [start**2], t_eval=times, rtol=1e-10, atol=1e-12)
    found = ms.decay_amplitude(flow, start, times)
    assert found == pytest.approx(np.sqrt(run.y[0]), rel=1e-6)
    assert np.all(ms.decay_bound(flow, start, times) >= found - 1e-9)
    share = -0.5 * flow.mass_ratio * rate(0, start**2) / start**2
    assert ms.damping_ratio(flow, start) == pytest.approx(share, rel=1e-10)
    assert ms.damping_ratio(flow) == pytest.approx(ms.damping_ratio(flow, 1e7), rel=1e-5)
