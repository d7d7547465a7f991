"""Normal forms of codimension two: known ones, bent by coordinate changes with an inverse in closed form, are found again."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.normal_forms.coefficients import Forms, forms_at
from contvines.bifurcation.normal_forms.critical import normal_form


class Bend:
    """x -> x + quadratic and cubic parts of the coordinates before it, one coordinate after the other; linear part 1."""

    def __init__(self, n, seed):
        rng = np.random.default_rng(seed)
        self.rounds = []
        for _ in range(2):
            for i in rng.permutation(n):
                others = [j for j in range(n) if j != i]
                self.rounds.append((i, others, 0.4 * rng.standard_normal(3)))

    @staticmethod
    def _add(x, others, c):
        y = [x[j] for j in others]
        return c[0] * y[0] * y[-1] + c[1] * y[-1] ** 2 + c[2] * y[0] ** 3

    def __call__(self, x):
        x = list(x)
        for i, others, c in self.rounds:
            x[i] = x[i] + self._add(x, others, c)
        return x

    def back(self, x):
        x = list(x)
        for i, others, c in reversed(self.rounds):
            x[i] = x[i] - self._add(x, others, c)
        return x


def bent_map(N, n, seed=1):
    bend = Bend(n, seed)
    problem = cv.MapProblem(lambda x, p: np.array(bend(N(bend.back(x)))), np.zeros(n), 0.0)
    return Forms(problem, np.zeros(n), 0.0)


def bent_flow(N, n, seed=1):
    bend = Bend(n, seed)

    def f(x, p):
        y = bend.back(x)
        rate = N(y)
        # derivative of the bend along the rate, by the chain rule through its rounds
        z, dz = list(y), list(rate)
        for i, others, c in bend.rounds:
            a, b = z[others[0]], z[others[-1]]
            da, db = dz[others[0]], dz[others[-1]]
            dz[i] = dz[i] + c[0] * (da * b + a * db) + 2 * c[1] * b * db + 3 * c[2] * a * a * da
            z[i] = z[i] + Bend._add(z, others, c)
        return np.array(dz)

    return Forms(cv.AlgebraicProblem(f, np.zeros(n), 0.0, spectrum="flow"), np.zeros(n), 0.0)


def polar(x, y, factor):
    """Real and imaginary part of factor (x + i y), for complex numbers given by their parts."""
    return factor[0] * x - factor[1] * y, factor[0] * y + factor[1] * x


def test_generalized_hopf():
    omega, c1, c2 = 1.3, (0.0, -0.7), (0.45, 0.2)

    def N(w):
        r = w[0] ** 2 + w[1] ** 2
        return polar(w[0], w[1], (c1[0] * r + c2[0] * r * r, omega + c1[1] * r + c2[1] * r * r))

    found = normal_form("generalized-hopf", bent_flow(N, 2), [1j * omega])
    assert found["l1"] == pytest.approx(0.0, abs=1e-9)
    assert found["l2"] == pytest.approx(4 * c2[0] / omega, abs=1e-8)


def test_double_multipliers():
    one = bent_map(lambda w: [w[0] + w[1], w[1] + 0.7 * w[0] ** 2 - 1.3 * w[0] * w[1]], 2, 5)
    assert normal_form("resonance-1-1", one, []) == pytest.approx({"a": 0.7, "b": -1.3}, abs=1e-9)
    two = bent_map(lambda w: [-w[0] + w[1], -w[1] + 0.7 * w[0] ** 3 - 1.3 * w[0] ** 2 * w[1]], 2, 5)
    assert normal_form("resonance-1-2", two, []) == pytest.approx({"c": 0.7, "d": -1.3}, abs=1e-9)
    flow = bent_flow(lambda w: [w[1], 0.7 * w[0] ** 2 - 1.3 * w[0] * w[1]], 2, 5)
    assert normal_form("bogdanov-takens", flow, []) == pytest.approx({"a": 0.7, "b": -1.3}, abs=1e-9)


def test_a_double_zero_beside_a_pole():
    """Bazykin's predator and prey, whose rates have a pole at x = -1 / al: wide samples lie on both sides of it.

    Where F, trace and determinant vanish, and a and b there by Kuznetsov's formulas (Elements, 8.54): mpmath and SymPy, thirty digits. With the length of
    the critical vector both change alike.
    """
    units = np.array([50.0, 5.0])

    def rates(u, p):
        x, y = units * u
        eaten = x * y / (1 + p.al * x)
        return np.array([x - eaten - x**2 / 100, -y + eaten - p.de * y**2]) / units

    place = np.array([6.26576552895236307, 3.60155393683666477]) / units
    values = {"al": 0.45362432777812945521, "de": 0.17512759295021742421}
    problem = cv.AlgebraicProblem(rates, place, values, parameter="al", spectrum="flow")
    found = normal_form("bogdanov-takens", forms_at(problem, place, values["al"]), [])
    assert found["b"] / found["a"] == pytest.approx(-0.05253877649285624 / 0.039453091123676357, rel=1e-9)


def test_strong_resonances_three_and_four():
    b, c = (0.5, 0.4), (-0.3, 0.9)

    def third(w):
        x, y = w
        r = x * x + y * y
        # m z + b conj(z)^2 + c z |z|^2
        m = polar(x, y, (np.cos(2 * np.pi / 3), np.sin(2 * np.pi / 3)))
        square = polar(x * x - y * y, -2 * x * y, b)
        cube = polar(x * r, y * r, c)
        return [m[i] + square[i] + cube[i] for i in range(2)]

    found = normal_form("resonance-1-3", bent_map(third, 2), [np.exp(2j * np.pi / 3)])
    turned = complex(*c) * np.exp(-2j * np.pi / 3)
    assert found["b"] == pytest.approx(np.sqrt(2) * np.hypot(*b), abs=1e-9)
    assert found["a"] == pytest.approx((turned.real / np.hypot(*b) ** 2 - 1) / 3, abs=1e-8)

    def fourth(w):
        x, y = w
        r = x * x + y * y
        cube = polar(x * r, y * r, c)
        other = polar(x**3 - 3 * x * y * y, -(3 * x * x * y - y**3), b)
        return [-y + cube[0] + other[0], x + cube[1] + other[1]]

    found = normal_form("resonance-1-4", bent_map(fourth, 2), [1j])
    A = -1j * complex(*c) / np.hypot(*b)
    assert complex(found["A_re"], found["A_im"]) == pytest.approx(A, abs=1e-8)


@pytest.mark.slow
def test_fold_and_pair():
    omega, b, c, D = 1.4, 0.6, -0.7, (0.5, 0.2)

    def flow(w):
        x, y, z = w
        r = y * y + z * z
        pair = polar(y, z, (D[0] * x + 0.35 * x * x, omega + D[1] * x))
        return [b * x * x + c * r, *pair]

    found = normal_form("zero-hopf", bent_flow(flow, 3, 7), [1j * omega])
    assert found["s"] == -1.0 and found["theta"] == pytest.approx(D[0] / b, abs=1e-9)
    assert found["b"] == pytest.approx(b, abs=1e-9) and found["c"] == pytest.approx(2 * c, abs=1e-9)
    assert found["e"] == pytest.approx(
        0.35, abs=1e-8
    )  # what is left of the cubic terms is in the normal form already

    def step(w):
        x, y, z = w
        turned = polar(y, z, (np.cos(omega), np.sin(omega)))
        return [x + b * x * x + c * (y * y + z * z), *polar(*turned, (1 + D[0] * x, D[1] * x))]

    found = normal_form("fold-neimark-sacker", bent_map(step, 3, 7), [np.exp(1j * omega)])
    assert found["theta"] == pytest.approx(D[0] / b, abs=1e-9) and found["s"] == -1.0


@pytest.mark.slow
def test_two_amplitudes():
    p = np.array([[-0.4, 0.7], [0.3, 0.5]])
    angles = (0.8, 2.3)

    def growth(first, second):
        return [1 + p[i, 0] * first + p[i, 1] * second for i in range(2)]

    def pairs(w):
        g = growth(w[0] ** 2 + w[1] ** 2, w[2] ** 2 + w[3] ** 2)
        parts = [polar(w[2 * i], w[2 * i + 1], (np.cos(t), np.sin(t))) for i, t in enumerate(angles)]
        return [g[i] * x for i in range(2) for x in parts[i]]

    critical = [np.exp(1j * t) for t in angles]
    found = normal_form("double-neimark-sacker", bent_map(pairs, 4), critical)
    assert found["theta"] == pytest.approx(p[0, 1] / p[1, 1], abs=1e-7)
    assert found["delta"] == pytest.approx(p[1, 0] / p[0, 0], abs=1e-7)
    assert found["p11"] == pytest.approx(2 * p[0, 0], abs=1e-7)

    def flip(w):
        g = growth(w[0] ** 2, w[1] ** 2 + w[2] ** 2)
        turned = polar(w[1], w[2], (np.cos(angles[0]), np.sin(angles[0])))
        return [-g[0] * w[0], g[1] * turned[0], g[1] * turned[1]]

    found = normal_form("flip-neimark-sacker", bent_map(flip, 3), critical[:1])
    assert found["p11"] == pytest.approx(p[0, 0], abs=1e-7)
    assert found["theta"] == pytest.approx(p[0, 1] / p[1, 1], abs=1e-7)
    assert found["delta"] == pytest.approx(p[1, 0] / p[0, 0], abs=1e-7)

    def flow(w):
        g = growth(w[0] ** 2 + w[1] ** 2, w[2] ** 2 + w[3] ** 2)
        parts = [polar(w[2 * i], w[2 * i + 1], (g[i] - 1, t)) for i, t in enumerate(angles)]
        return [x for part in parts for x in part]

    found = normal_form("double-hopf", bent_flow(flow, 4), [1j * t for t in angles])
    assert found["theta"] == pytest.approx(p[0, 1] / p[1, 1], abs=1e-7)
    assert found["delta"] == pytest.approx(p[1, 0] / p[0, 0], abs=1e-7)
