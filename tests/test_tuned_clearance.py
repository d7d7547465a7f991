"""The best clearance of multiple scales: published numbers, and exact motions with impacts that approach it."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import contvines as cv
from orbits import Coupled
from orbits import multiple_scales as ms

pytestmark = pytest.mark.slow

RESTITUTION = 0.8
SHARE = 0.02  # of all mass: the absorber's
DAMPING_RATIO = 1e-3  # with the absorber held fast


def published_flow():
    """The slow flow of the published case: m/(M + m) = 0.02, D = 1e-3 of M + m on the spring."""
    eps = SHARE / (1.0 - SHARE)
    return ms.SlowFlow(
        restitution=RESTITUTION,
        friction=0.0,
        mass_ratio=eps,
        damping=2.0 * DAMPING_RATIO * math.sqrt(1.0 + eps) / eps,
    )


def test_the_best_clearance_is_the_published_one():
    """0.33866487 at q/clearance = 0.57027232: the single-harmonic backbone of Weidemann, Bergman, Vakakis and Krack (2025), from their own
    equation |(1 - (1 - e) W^2 + 2 i D W) x - (8/pi^2) e W^2 T (T - 1 - i p T)/x| ratio = 2 D with T the absorber's amplitude."""
    found = ms.best_clearance(published_flow())
    assert found.interior
    assert (found.ratio, found.amplitude) == pytest.approx((0.33866487, 0.57027232), abs=5e-9)
    x, frequency, e = found.amplitude, found.frequency, SHARE
    p = (2.0 / math.pi) * (1.0 - RESTITUTION) / (1.0 + RESTITUTION)
    big = (1.0 + math.sqrt((1.0 + p * p) * x * x - p * p)) / (1.0 + p * p)
    stiffness = (1.0 - (1.0 - e) * frequency**2 + 2.0j * DAMPING_RATIO * frequency) * x
    balance = stiffness - (8.0 / math.pi**2) * e * frequency**2 * big * ((big - 1.0) / x - 1.0j * p * big / x)
    assert balance.real == pytest.approx(0.0, abs=1e-12)
    assert 2.0 * DAMPING_RATIO / abs(balance) == pytest.approx(found.ratio, rel=1e-12)


def velocities(flow, count):
    return np.linspace(float(flow.activation.velocity), float(flow.symmetry_limit.velocity), count)


def test_the_best_clearance_is_the_top_of_the_tuned_backbone():
    flow = published_flow()
    curve, best = ms.tuned_backbone(flow, velocities(flow, 20001)), ms.best_clearance(flow)
    top = int(np.argmax(curve.ratio))
    assert curve.ratio[top] == pytest.approx(best.ratio, rel=1e-8)
    assert curve.velocity[top] == pytest.approx(best.velocity, abs=1e-4)
    assert best.reduction == pytest.approx(best.ratio * best.amplitude, rel=1e-15)


def test_with_a_vanishing_absorber_it_is_the_slow_flows():
    """To leading order the ratio is lambda/G on `backbone`, whose least forcing a dense scan finds."""
    flow = published_flow().with_(mass_ratio=1e-9)
    slow, best = ms.backbone(flow, velocities(flow, 200001)), ms.best_clearance(flow)
    least = int(np.argmin(slow.forcing))
    assert best.ratio == pytest.approx(float(flow.damping) / slow.forcing[least], rel=1e-7)
    assert best.amplitude == pytest.approx(slow.amplitude[least], abs=1e-4)


def exact_ratio(flow):
    """The largest half-width over the linear peak of exact motions, from continuation alone: at each frequency the forcing at which
    the first harmonic of the oscillator is a quarter of a period behind it, then the least of these forcings over the frequency.

    The harmonic solves x'' + eps lambda x' + x = F + impulses, of which a node (phase, B at the left wall) tells size and phase.
    """
    eps, damping = float(flow.mass_ratio), float(flow.damping)
    machine = Coupled(
        mass_ratio=eps, restitution=RESTITUTION, friction=0.0, gravity=0.2, damping=damping, excitation=0.0
    )
    theory = ms.best_clearance(flow)
    near = damping / (theory.ratio * math.sqrt(1.0 + eps)), theory.frequency / math.sqrt(1.0 + eps)

    def resonant_forcing(detuning):
        frequency = near[1] + eps * detuning

        def in_phase(u, forcing):
            jump = 2.0 * eps * u[1] / (1.0 + eps)
            push = -2.0 * frequency * jump / math.pi * complex(math.sin(u[0]), math.cos(u[0]))
            return ((eps * forcing + push) / (1.0 - frequency**2 + 1.0j * eps * damping * frequency)).real

        start = machine.orbit("LR", forcing=1.3 * near[0], frequency=frequency)
        graph = cv.diagram(
            start,
            over="forcing",
            within=(0.8 * near[0], 1.31 * near[0]),
            depth=0,
            user_functions={"resonance": in_phase},
        )
        return min(point.value for point in graph.of_kind("user") if point.real)

    options = {"bounds": (-0.25, 0.25), "method": "bounded", "options": {"xatol": 1e-3}}
    return damping / (math.sqrt(1.0 + eps) * minimize_scalar(resonant_forcing, **options).fun)


def test_exact_motions_approach_it_with_order_one_in_the_mass_ratio():
    """Halving the mass ratio at a fixed damping of the slow flow halves the distance between theory and exact motions."""
    flow = published_flow()
    distances = []
    for part in (1.0, 0.5, 0.25):
        lighter = flow.with_(mass_ratio=part * flow.mass_ratio)
        distances.append(exact_ratio(lighter) / ms.best_clearance(lighter).ratio - 1.0)
    assert 0.001 < abs(distances[0]) < 0.02
    orders = [math.log2(a / b) for a, b in pairwise(distances)]
    assert orders == pytest.approx([1.0, 1.0], abs=0.1)
