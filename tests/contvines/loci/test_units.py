"""Loci and points of codimension two do not depend on the units of unknowns, parameters and time."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import contvines as cv
from contvines.loci.codimension_two import coefficients, find
from orbits.machines.physical import physical
from tests.contvines.loci.systems import generalized_henon
from tests.contvines.loci.test_absorber_loci import closed_form

pytestmark = pytest.mark.slow

powers = st.floats(-6.0, 6.0).map(lambda exponent: 10.0**exponent)


def henon(U, P, Q):
    """The generalized Henon map, a Neimark-Sacker locus with resonances 1:2, 1:3 and 1:4; be in units of P, al of Q, x of U."""

    problem = generalized_henon(al=0.1, units=(U, P, Q))
    graph = cv.diagram(problem, over="be", within=(0.1 * P, 1.5 * P), depth=0)
    locus = cv.locus(graph["NS1"], over="al", within=(-0.5 * Q, 3.0 * Q), bounds=(0.1 * P, 1.5 * P))
    points = [point for _, point in find(locus)]
    return locus.values / (P, Q), [
        (point.kind, point.value[0] / P, point.value[1] / Q, coefficients(point)) for point in points
    ]


@pytest.fixture(scope="module")
def plain():
    return henon(1.0, 1.0, 1.0)


@settings(max_examples=1)
@given(powers, powers, powers)
@example(1e-6, 1e6, 1e-6)
@example(1e6, 1e-6, 1e6)
def test_a_map_in_other_units(plain, U, P, Q):
    values, points = plain
    assert [kind for kind, *_ in points].count("resonance-1-3") == 1
    other, found = henon(U, P, Q)
    assert abs(len(other) - len(values)) <= 2
    assert [kind for kind, *_ in found] == [kind for kind, *_ in points]
    for (_, be, al, own), (_, p, q, there) in zip(points, found):
        assert (p, q) == pytest.approx((be, al), abs=1e-10)
        assert set(there) == set(own)
        for name in own:  # cubic coefficients are per square of an unknown, quadratic ones per unknown
            power = {"a": 0, "b": 1, "A_re": 0, "A_im": 0, "c": 2, "d": 2}[name]
            assert there[name] * U**power == pytest.approx(own[name], rel=1e-6)


@pytest.mark.parametrize("b", [0.02, 1000.0])
def test_a_machine_in_millimetres(b):
    """Amplitude against half-width, both in mm; the closed form knows ratios only."""
    rate, g = 2.0 * np.pi * 2.0, 0.2 * b * (2.0 * np.pi * 2.0) ** 2
    given = {
        "amplitude": f"{0.6 * b} mm",
        "half_width": f"{b} mm",
        "frequency": "2 Hz",
        "natural_frequency": "2 Hz",
    }
    given |= {"restitution": 0.76, "friction": 0.5, "gravity": f"{g / 1e3} m/s^2"}
    machine = physical("absorber", given | {"oscillator_mass": "1 kg", "absorber_mass": "6 g"})
    graph = cv.diagram(machine.orbit("LR"), over="amplitude", within=(0.4 * b, 0.8 * b), depth=0)
    (point,) = graph.of_kind("symmetry-breaking")
    locus = cv.locus(point, over="half_width", within=(0.8 * b, 1.6 * b), bounds=(0.0, 2.0 * b))
    assert 8 < len(locus) < 60
    for amplitude, width in locus.values:
        ratio = closed_form("symmetry-breaking", gravity=g / (width * rate**2))
        assert amplitude == pytest.approx(ratio * width, rel=1e-12)
    assert len(locus.at(1.2 * b)) == 1
