"""Each slip listed in examples/ERRATA.md, shown by a number that does not come from the code under test."""

from itertools import pairwise

import numpy as np
import pytest

from orbits import Absorber, Coupled, Orbit, Word
from orbits import multiple_scales as ms
from orbits.design import Design
from orbits.starts.find import polish

pytestmark = pytest.mark.slow

STRONG = {"restitution": 0.76, "friction": 0.5, "gravity": 0.211}
R, H = 0.24 / 1.76, 0.5 * np.pi * 0.5 * 0.211


@pytest.fixture(scope="module")
def state():
    """The steady state with impacts of the slow flow at sigma = -2.58."""
    return next(s for s in ms.equilibria(ms.SlowFlow(), -2.58) if s.seen and s.manifold == "impacting")


def exact_orbit(eps, state):
    """The symmetric orbit of the exact coupled machine near a state of the slow flow."""
    machine = Coupled(**STRONG, mass_ratio=eps, damping=0.9, forcing=2.47, frequency=1 - 2.58 * eps)
    b = state.velocity
    sine, cosine = 1 - 0.5 * np.pi * b, R * b + H
    phase = np.arctan2(sine, cosine) - state.phase
    nodes = np.array([[phase, b + H, sine, cosine], [phase + np.pi, -b - H, -sine, -cosine]])
    orbit = polish(Orbit(machine, Word.parse("LR"), 1, nodes, machine.vector({})))
    assert orbit is not None and orbit.residual < 1e-11
    return orbit


def seen(orbit):
    """(B, C^2, gamma) of an orbit."""
    t = orbit.events
    v, rate = t.v[0], t.v_rate[0] / orbit.model.frequency
    mean = 0.5 * (t.B_post[0] - t.B_pre[0])
    return np.array([mean, v**2 + rate**2, np.angle(np.exp(1j * (np.arctan2(v, rate) - t.phase[0])))])


def test_first_slow_equation_has_four_over_pi(state):
    """Put into it: the exact orbit, extrapolated to eps -> 0 (twice Richardson), which is the slow flow's state."""
    rows = [seen(exact_orbit(eps, state)) for eps in (8e-4, 4e-4, 2e-4)]
    first = [2 * b - a for a, b in pairwise(rows)]
    b, squared, gamma = found = (4 * first[1] - first[0]) / 3
    assert found == pytest.approx([state.velocity, state.amplitude**2, state.phase], abs=1e-7)

    def remainder(factor):
        ripple = 8 / np.pi**2 * H * (1 - 0.5 * np.pi * b)
        return -0.9 * squared - factor * b * (R * b + H) - ripple - 2.47 * np.sqrt(squared) * np.sin(gamma)

    assert abs(remainder(4 / np.pi)) < 1e-8
    assert abs(remainder(np.pi / 4)) == pytest.approx(0.150, abs=1e-3)


def test_slow_eigenvalues_are_the_limit_of_coupled_multipliers(state):
    """log(multiplier)/(eps T) of the two slow multipliers -> eigenvalues of the slow flow, to first order."""
    gaps = []
    for eps in (0.003, 0.0015, 0.00075):
        orbit = exact_orbit(eps, state)
        slow = orbit.multipliers[np.argsort(np.abs(orbit.multipliers - 1))[:2]]
        rates = np.log(slow) * orbit.model.frequency / (2 * np.pi * eps)
        gaps.append(np.max(np.abs(np.sort_complex(rates) - np.sort_complex(np.array(state.eigenvalues)))))
    orders = np.log2(np.array(gaps[:-1]) / np.array(gaps[1:]))
    assert gaps[-1] < 1e-3 and np.all(np.abs(orders - 1) < 0.05)


def test_printed_resonance_frequency_has_no_dimension():
    """The corrected one gives the same hertz in metres and millimetres; the printed one does not."""
    flow = ms.SlowFlow()
    c, low = ms.coefficients(flow), flow.activation.amplitude

    def printed(q, b):
        return 0.5 / (b * q) * (c.offset_gamma - c.beta_gamma * np.sqrt(q - b * low))

    def corrected(q, b):
        return ms.resonance_frequency(q, cavity=b, natural_frequency=7.666, flow=flow)

    assert printed(0.015, 0.02) / printed(15.0, 20.0) != pytest.approx(1.0, rel=0.5)
    assert corrected(0.015, 0.02) == pytest.approx(corrected(15.0, 20.0))


def test_speed_before_an_impact_has_the_other_sign():
    orbit = Absorber(**STRONG, mass_ratio=0.006).symmetric_orbit(float(np.sqrt(0.53)))
    after, before = orbit.events.B_post[0], orbit.events.B_pre[0]
    assert (after, before) == (pytest.approx(1.2225, abs=1e-4), pytest.approx(-0.8891, abs=1e-4))
    mean = 0.5 * (after - before)
    h = 1.006 * H
    assert (1 - 0.5 * np.pi * mean) ** 2 + (R * mean + h) ** 2 == pytest.approx(0.53, abs=1e-12)
    # printed map G-_LR: r B-_n + B-_(n+1) - (1 + r) C cos Psi_n + a pi = 0 with the signed speeds
    cosine = np.sqrt(0.53) * np.cos(orbit.events.phase[0])
    assert 0.76 * before + orbit.events.B_pre[1] - 1.76 * cosine + 2 * h == pytest.approx(0.0, abs=1e-12)


def test_upper_bound_falls_with_the_cavity_only_for_bouncy_walls():
    """The dimensionless C_max rises with h (falls with b) while 4 R^2 < pi^2 - 8; in metres q1_max rises
    with b."""
    for r, rises in ((0.5, True), (0.2, True), (0.17, False)):
        b = np.array([10.0, 11.0])  # very wide: small h
        wide = Design(cavity=b, restitution=r, mass_ratio=0.0)
        scaled = np.asarray(wide.upper_bound) / b
        assert (scaled[0] > scaled[1]) == rises
        assert wide.upper_bound[0] < wide.upper_bound[1]
