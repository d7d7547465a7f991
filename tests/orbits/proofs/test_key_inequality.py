"""The step from an inequality to existence, derived a second time, and the derivatives beneath it."""

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orbits.proofs.balls import ball, precision
from orbits.proofs.enclosing import enclose
from orbits.proofs.equations import Motif, System
from orbits.proofs.jets import Jet, exp, power, sin_cos, sqrt
from orbits.proofs.obstacles import Obstacle

pytestmark = pytest.mark.slow


class Polynomial(System):
    """One unknown, one equation: a polynomial with given coefficients."""

    def __init__(self, coefficients):
        super().__init__(Motif("absorber", ("t",), (1,), 1, False, False), {})
        self.coefficients, self.k = coefficients, 1

    def prepare(self, extras):
        return None

    def block(self, i, shared, z, following, extras):
        value = 0 * z[0] + self.coefficients[0]
        for coefficient in self.coefficients[1:]:
            value = value * z[0] + coefficient
        return [value]

    def closing(self, z, extras):
        return list(z)


def test_no_simple_root_no_proof():
    """x^2 + d has none, for d > 0 however small, and for d = 0."""
    for small in ("1e-6", "1e-12", "1e-18", "0"):
        with pytest.raises(Obstacle), precision(160):
            system = Polynomial([ball("1"), ball("0"), ball(small)])
            enclose(system, [[ball("0.0000001")]], [], 160)


@settings(max_examples=40, deadline=None)
@given(x=st.floats(0.1, 3.0), y=st.floats(0.1, 3.0), exponent=st.sampled_from([-2, -1, 0.5, 1, 2, 3]))
def test_derivatives_are_those_of_mpmath(x, y, exponent):
    def f(u, v, sine, exponential, root, raised):
        whole = sine(u * v) / (1 + u * u) + exponential(-v) * root(u + v) - v / u
        return whole + raised(u, exponent)

    with precision(120):
        u, v = Jet(Jet(ball(x), {0: ball("1")}), {0: ball("1")}), Jet(Jet(ball(y), {}), {})
        inner = f(u, v, lambda z: sin_cos(z)[0], exp, sqrt, power)
        ours = inner.value.value, inner.partials[0].value, inner.partials[0].partials[0]
    with mpmath.workdps(40):
        functions = mpmath.mpf(y), mpmath.sin, mpmath.exp, mpmath.sqrt, mpmath.power
        for order, value in enumerate(ours):
            expected = mpmath.diff(lambda u: f(u, *functions), mpmath.mpf(x), order)
            assert float(value) == pytest.approx(float(expected), rel=1e-10, abs=1e-10)
