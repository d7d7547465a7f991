"""Normal forms of codimension two: known ones, bent by coordinate changes with an inverse in closed form, are found again."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.normal_forms.coefficients import Forms, forms_at
from contvines.bifurcation.normal_forms.critical import normal_form
from tests.contvines.loci.systems import BAZYKIN_DOUBLE_ZERO, BAZYKIN_PLACE, bazykin


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


def bent_map(N, n, seed):
    bend = Bend(n, seed)
    return cv.MapProblem(lambda x, p: np.array(bend(N(bend.back(x)))), np.zeros(n), 0.0)


def bent_flow(N, n, seed):
    bend = Bend(n, seed)

    def f(x, p):
        z = bend.back(x)
        dz = N(z)
        # derivative of the bend along the rate, by the chain rule through its rounds
        for i, others, c in bend.rounds:
            a, b = z[others[0]], z[others[-1]]
            da, db = dz[others[0]], dz[others[-1]]
            dz[i] = dz[i] + c[0] * (da * b + a * db) + 2 * c[1] * b * db + 3 * c[2] * a * a * da
            z[i] = z[i] + Bend._add(z, others, c)
        return np.array(dz)

    return cv.AlgebraicProblem(f, np.zeros(n), 0.0, spectrum="flow")


def polar(x, y, factor):
    """Real and imaginary part of factor (x + i y), for complex numbers given by their parts."""
    return [factor[0] * x - factor[1] * y, factor[0] * y + factor[1] * x]


def circle(angle):
    return np.cos(angle), np.sin(angle)


def square(*parts):
    return sum(part**2 for part in parts)


OMEGA = 1.4
P = np.array([[-0.4, 0.7], [0.3, 0.5]])  # of two amplitudes
ANGLES = (0.8, 2.3)
B, C = (0.5, 0.4), (-0.3, 0.9)  # of strong resonances


def added(m, w, conjugate):
    """m z + B times a power of conj(z) + C z |z|^2."""
    r = square(*w)
    parts = polar(*w, m), polar(*conjugate(*w), B), polar(w[0] * r, w[1] * r, C)
    return [sum(part) for part in zip(*parts)]


def growth(first, second):
    return [1 + row[0] * first + row[1] * second for row in P]


def generalized_hopf(w):
    r = square(*w)
    return polar(*w, (0.45 * r * r, 1.3 - 0.7 * r + 0.2 * r * r))


def zero_hopf(w):
    x, y, z = w
    pair = polar(y, z, (0.5 * x + 0.35 * x * x, OMEGA + 0.2 * x))
    return [0.6 * x * x - 0.7 * square(y, z), *pair]


def fold_neimark_sacker(w):
    x, y, z = w
    return [x + 0.6 * x * x - 0.7 * square(y, z), *polar(*polar(y, z, circle(OMEGA)), (1 + 0.5 * x, 0.2 * x))]


def double_neimark_sacker(w):
    parts = polar(*w[:2], circle(ANGLES[0])), polar(*w[2:], circle(ANGLES[1]))
    return [g * x for g, part in zip(growth(square(*w[:2]), square(*w[2:])), parts) for x in part]


def flip_neimark_sacker(w):
    g = growth(w[0] ** 2, square(*w[1:]))
    return [-g[0] * w[0], *(g[1] * x for x in polar(*w[1:], circle(ANGLES[0])))]


def double_hopf(w):
    g = growth(square(*w[:2]), square(*w[2:]))
    return [*polar(*w[:2], (g[0] - 1, ANGLES[0])), *polar(*w[2:], (g[1] - 1, ANGLES[1]))]


FOLD_AND_PAIR = {"s": -1.0, "theta": 0.5 / 0.6}
TWO = {"theta": P[0, 1] / P[1, 1], "delta": P[1, 0] / P[0, 0]}
A = -1j * complex(*C) / np.hypot(*B)
TURNED = complex(*C) * np.exp(-2j * np.pi / 3)
THIRD = {
    "b": np.sqrt(2) * np.hypot(*B),
    "a": (TURNED.real / np.hypot(*B) ** 2 - 1) / 3,
}
pair, slow = np.exp(1j * OMEGA), pytest.mark.slow


@pytest.mark.parametrize(
    ("problem", "kind", "critical", "exact"),
    [
        (bent_flow(generalized_hopf, 2, 1), "generalized-hopf", [1.3j], {"l1": 0.0, "l2": 4 * 0.45 / 1.3}),
        (bent_flow(lambda w: [w[1], 0.7 * w[0] ** 2 - 1.3 * w[0] * w[1]], 2, 5), "bogdanov-takens", [], {"a": 0.7, "b": -1.3}),
        (bent_map(lambda w: added(circle(2 * np.pi / 3), w, lambda x, y: (x * x - y * y, -2 * x * y)), 2, 1), "resonance-1-3",
         [np.exp(2j * np.pi / 3)], THIRD),
        (bent_map(lambda w: added((0, 1), w, lambda x, y: (x**3 - 3 * x * y * y, y**3 - 3 * x * x * y)), 2, 1), "resonance-1-4",
         [1j], {"A_re": A.real, "A_im": A.imag}),
        (bent_map(lambda w: [w[0] + w[1], w[1] + 0.7 * w[0] ** 2 - 1.3 * w[0] * w[1], 0.4 * w[2]], 3, 5), "resonance-1-1", [], {"a": 0.7, "b": -1.3}),
        (bent_map(lambda w: [-w[0] + w[1], -w[1] + 0.7 * w[0] ** 3 - 1.3 * w[0] ** 2 * w[1], 0.4 * w[2]], 3, 5), "resonance-1-2", [],
         {"c": 0.7, "d": -1.3}),
        # what is left of the cubic terms is in the normal form already
        pytest.param(bent_flow(zero_hopf, 3, 7), "zero-hopf", [1j * OMEGA], FOLD_AND_PAIR | {"b": 0.6, "c": -1.4, "e": 0.35}, marks=slow),
        pytest.param(bent_map(fold_neimark_sacker, 3, 7), "fold-neimark-sacker", [pair], FOLD_AND_PAIR, marks=slow),
        pytest.param(bent_map(double_neimark_sacker, 4, 1), "double-neimark-sacker", [np.exp(1j * t) for t in ANGLES],
                     TWO | {"p11": 2 * P[0, 0]}, marks=slow),
        pytest.param(bent_map(flip_neimark_sacker, 3, 1), "flip-neimark-sacker", [np.exp(1j * ANGLES[0])], TWO | {"p11": P[0, 0]}, marks=slow),
        pytest.param(bent_flow(double_hopf, 4, 1), "double-hopf", [1j * t for t in ANGLES], TWO, marks=slow),
    ],
)  # fmt: skip
def test_a_bent_normal_form_is_found_again(problem, kind, critical, exact):
    found = normal_form(kind, Forms(problem, problem.u0, 0.0), critical)
    assert {name: found[name] for name in exact} == pytest.approx(exact, abs=1e-9)


def test_a_double_zero_beside_a_pole():
    """Bazykin's predator and prey, whose rates have a pole at x = -1 / alpha: wide samples lie on both sides of it.

    a and b by Kuznetsov's formulas (Elements, 8.54): SymPy, thirty digits. With the length of the critical vector both change alike.
    """
    units = np.array([50.0, 5.0])
    alpha, delta = BAZYKIN_DOUBLE_ZERO
    problem = cv.AlgebraicProblem(
        lambda u, p: bazykin(units * u, p) / units,
        BAZYKIN_PLACE / units,
        {"alpha": alpha, "delta": delta},
        spectrum="flow",
    )
    found = normal_form("bogdanov-takens", forms_at(problem, problem.u0, alpha), [])
    assert found["b"] / found["a"] == pytest.approx(-0.05253877649285624 / 0.039453091123676357, rel=1e-9)
