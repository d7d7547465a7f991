"""The absorber on its oscillator, frequency against forcing: where the response becomes modulated, in many digits; borders on their regular side."""

import mpmath as mp
import numpy as np
import pytest

import contvines as cv
from contvines.loci.codimension_two import find
from orbits import Coupled

pytestmark = pytest.mark.slow

MACHINE = {"damping": 1.0, "mass_ratio": 0.006, "restitution": 0.76, "friction": 0.5, "gravity": 0.211}
BOUNDS = (0.92, 1.09)


@pytest.fixture(scope="module")
def graph():
    orbit = Coupled(forcing=2.47, **MACHINE).orbit("LR", frequency=1.02)
    return cv.diagram(orbit, over="frequency", within=(0.985, 1.03), depth=0)


@pytest.fixture(scope="module")
def modulated(graph):
    """The Neimark-Sacker locus and the points on it, by kind."""
    locus = cv.locus(graph["NS1"], over="forcing", within=(0.5, 4.0), bounds=BOUNDS)
    return locus, [point for _, point in find(locus)]


# ---------------------------------------------------------------------- the half map, written anew
def later(x, T, frequency, forcing):
    """(q1, q1', q2, q2') a time T after the left wall was left with x = (phase, q1, q1', q2'): friction pulls the absorber back."""
    phase, q, rate, other = x
    eps, lam, mu, g = (mp.mpf(str(MACHINE[k])) for k in ("mass_ratio", "damping", "friction", "gravity"))
    d, W = eps * lam, frequency
    # q'' + d q' + q = forcing (sin + d W cos)(phase + W t) + eps mu g: the response to exp(i (phase + W t)) is its real factor
    factor = eps * forcing * (1 + 1j * d * W) / (1 - W * W + 1j * d * W)

    def driven(t):
        z = factor * mp.e ** (1j * (phase + W * t))
        return mp.im(z) + eps * mu * g, mp.im(1j * W * z)

    start, w = driven(0), mp.sqrt(1 - d * d / 4)
    a, b = q - start[0], rate - start[1]
    decay, c, s = mp.e ** (-d * T / 2), mp.cos(w * T), mp.sin(w * T)
    free = decay * (a * c + (b + d * a / 2) / w * s)
    free_rate = decay * (b * c - (a + d * b / 2) / w * s)
    end = driven(T)
    second = q - 1 + other * T - mu * g * T * T / 2
    return end[0] + free, end[1] + free_rate, second, other - mu * g * T


def half(x, frequency, forcing, T=None):
    """From one left wall to its mirror image, the right wall: (phase, q1, q1', q2') after the impact there, mirrored, and w there."""
    r, eps = mp.mpf("0.76"), mp.mpf("0.006")
    if T is None:
        T = mp.findroot(
            lambda t: later(x, t, frequency, forcing)[0] - later(x, t, frequency, forcing)[2] + 1,
            mp.pi / frequency,
        )
    q, rate, second, other = later(x, T, frequency, forcing)
    centre, back = rate + eps * other, -r * (rate - other)
    after = (centre + eps * back) / (1 + eps), (centre - back) / (1 + eps)
    return [x[0] + frequency * T - mp.pi, -q, -after[0], -after[1]], q - second


def closed(x, frequency, forcing):
    """Zero for the symmetric motion: half a period later it is its mirror image, at the wall."""
    image, place = half(x, frequency, forcing, mp.pi / frequency)
    return [image[i] - x[i] for i in (1, 2, 3)] + [place + 1]


def polynomial(x, frequency, forcing):
    """Coefficients of the characteristic polynomial of the half map, highest power first."""
    h, M = mp.mpf(10) ** -14, mp.matrix(4)
    for k in range(4):
        ends = []
        for sign in (1, -1):
            y = list(x)
            y[k] += sign * h
            ends.append(half(y, frequency, forcing)[0])
        for i in range(4):
            M[i, k] = (ends[0][i] - ends[1][i]) / (2 * h)
    traces = [sum((M**k)[i, i] for i in range(4)) for k in range(1, 5)]
    c = [mp.mpf(1)]
    for k in range(1, 5):  # Newton's identities
        c.append(-sum(c[k - j] * traces[j - 1] for j in range(1, k + 1)) / k)
    return c


def start_of(problem, u, frequency):
    """(phase, q1, q1', q2') after the left wall, from the nodes (phase, v' - w', v, v')."""
    eps = 0.006
    phase, b, v, v_rate = problem.expand(u)[0]
    first = problem.word.events[0]
    assert first in "LR"
    sign = 1.0 if first == "L" else -1.0
    other = b / (1 + eps)
    return [
        phase + (0.0 if sign > 0 else np.pi),
        sign * (v + sign * eps) / (1 + eps),
        sign * (v_rate - eps * other),
        sign * other,
    ]


def test_the_onset_of_modulation_in_many_digits(modulated):
    locus, _ = modulated
    assert len(locus) > 20
    for i in np.linspace(4, len(locus) - 5, 4).astype(int):
        forcing, frequency = float(locus.branch.values[i]), float(locus.branch.points[i, -1])
        problem = locus.problem.at(forcing)
        multiplier = problem.orbit(locus.branch.points[i, : locus.size], frequency).half_multipliers
        pair = min(multiplier[multiplier.imag > 0], key=lambda m: abs(abs(m) - 1))

        def system(a, b, c, d, W, angle, forcing=forcing):
            x, m = (a, b, c, d), mp.e ** (1j * angle)
            value = mp.polyval(polynomial(x, W, mp.mpf(forcing)), m)
            return [*closed(x, W, mp.mpf(forcing)), mp.re(value), mp.im(value)]

        start = start_of(problem, locus.branch.points[i, : locus.size], frequency)
        with mp.workdps(30):
            exact = mp.findroot(
                system, [mp.mpf(float(s)) for s in (*start, frequency, np.angle(pair))], tol=1e-18
            )
        assert float(exact[4]) == pytest.approx(frequency, abs=1e-10)


def test_strong_resonance_and_fold_with_a_pair_in_many_digits(modulated):
    _, points = modulated

    def double(c):  # one is a double zero
        return [sum(c), sum((4 - k) * c[k] for k in range(4))]

    def with_pair(c):  # one is a zero, and the product of a pair: the fourth is the determinant
        return [sum(c), mp.polyval(c, c[4])]

    for kind, conditions in (("resonance-1-1", double), ("fold-neimark-sacker", with_pair)):
        (point,) = [p for p in points if p.kind == kind]

        def system(a, b, c, d, W, G, conditions=conditions):
            x = (a, b, c, d)
            return [*closed(x, W, G), *conditions(polynomial(x, W, G))]

        start = (*start_of(point.problem, point.u, point.value[0]), *point.value)
        with mp.workdps(30):
            exact = mp.findroot(system, [mp.mpf(float(s)) for s in start], tol=1e-18)
        assert (float(exact[4]), float(exact[5])) == pytest.approx(point.value, abs=1e-9)


def test_touched_borders_open_as_their_coefficients_say(graph):
    (graze,) = graph.of_kind("velocity-graze")
    locus = cv.locus(graze, over="forcing", within=(1.9, 3.0), bounds=BOUNDS)
    (point,) = [p for _, p in find(locus) if p.kind == "degenerate-border"]
    a, b = point.coefficients["a"], point.coefficients["b"]
    for step in (1e-4, 1e-3):
        wide = np.sqrt(-b * step / a)
        assert locus.at(point.value[1] + step) - point.value[0] == pytest.approx([-wide, wide], rel=1e-3)
    # with less forcing the response at any frequency keeps off the graze: the simulator says so
    for forcing, kept in ((point.value[1] - 0.02, True), (point.value[1] + 0.02, False)):
        orbit = Coupled(forcing=forcing, **MACHINE).orbit("LR", frequency=point.value[0])
        assert orbit.real is kept


# ---------------------------------------------------------------------- where the absorber begins to move
def forcing_that_moves_it(frequency):
    """The oscillator with the absorber stuck is linear: its largest acceleration is mu g."""
    eps, drag = MACHINE["mass_ratio"], MACHINE["mass_ratio"] * MACHINE["damping"] * frequency
    response = eps * np.hypot(1.0, drag) / np.hypot(1.0 - (1.0 + eps) * frequency**2, drag)
    return MACHINE["friction"] * MACHINE["gravity"] / (frequency**2 * response)


@pytest.fixture(scope="module")
def slipping():
    """Stick-slip up to the border at which the slips vanish, and the absorber stuck beyond."""
    orbit = Coupled(forcing=2.47, **MACHINE).attractor(frequency=1.06).orbit
    return cv.diagram(orbit, over="frequency", within=(1.055, 1.09), depth=1)


def test_the_border_of_the_stuck_absorber_has_a_locus_in_closed_form(slipping):
    point = next(s for s in slipping.special.values() if s.kind == "stick")
    assert forcing_that_moves_it(point.value) == pytest.approx(2.47, rel=1e-9)
    locus = cv.locus(point, over="forcing", within=(1.0, 4.0), bounds=(1.02, 1.2))
    assert len(locus) > 5 and locus.real.all()
    for frequency, forcing in locus.values:
        assert forcing == pytest.approx(forcing_that_moves_it(frequency), rel=1e-9)
