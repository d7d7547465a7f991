"""The exact frequency response at G = 2.47 against integration of the equations of motion.

Machine: r = 0.76, mu = 0.5, g = 0.211, eps = 0.006, damping 1. The integration (scipy's DOP853 over flights of given
length, so that no event is interpolated; Newton's method with differences of fourth order) takes its equations of motion
from `tests/orbits/machines/coupled/equations_of_motion.py`, which knows nothing of the package.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigvals
from scipy.optimize import brentq

import contvines as cv
from tests.machines import COUPLED
from tests.orbits.machines.coupled.equations_of_motion import TIGHT, right_side

pytestmark = pytest.mark.slow

WITHIN = (0.94, 1.07)
BORDERS = ("velocity-graze", "wall-graze", "stick")
# what the integration below gives; the compiled maps agree to 1e-11
FOLDS = (0.9717226436161, 1.0280413226418)
BREAKINGS = (0.9856523298452, 1.0037775486975)
NEIMARK_SACKER = (1.0254097153168, 1.0280328051003)  # on the fast and on the slow side of the fold
VELOCITY_GRAZES = (0.9939465060952, 0.9986022947078)
WALL_GRAZES = (0.9934295505152, 1.0063834057387)


# ---------------------------------------------------------------------- integration
def fly(params, psi, duration, y):
    """(q1, q1', q2, q2') after a flight with w' < 0; friction keeps its sign."""
    begin = psi / params[1]
    return solve_ivp(right_side(params, -1), (begin, begin + duration), y, **TIGHT).y[:, -1]


def after_left(params, x):
    """(q1, q1', q2, q2') just after the impact on the left wall with (Psi, B, v, v')."""
    eps, (_psi, B, v, v_rate) = params[3], x
    return [(v + eps) / (1 + eps), v_rate - eps * B / (1 + eps), (v - 1) / (1 + eps), B / (1 + eps)]


def half(z, Omega, machine=COUPLED):
    """From the impact on the left with z[:4] to that on the right, whose mirror image is z[4:]: four residuals."""
    params = machine.vector({"frequency": Omega})
    eps, r, there = params[3], params[4], z[4:]
    q1, p1, q2, p2 = fly(params, z[0], (there[0] + np.pi - z[0]) / Omega, after_left(params, z[:4]))
    v, v_rate = q1 + eps * q2, p1 + eps * p2
    return np.array([q1 - q2 + 1.0, -(v_rate + r * (p1 - p2)) - there[1], -v - there[2], -v_rate - there[3]])


def jacobian(f, z, h=5e-4):
    columns = []
    for unit in h * np.eye(len(z)):
        columns.append((8 * (f(z + unit) - f(z - unit)) - (f(z + 2 * unit) - f(z - 2 * unit))) / (12 * h))
    return np.array(columns).T


def newton(f, z):
    z = np.array(z, dtype=float)
    for _ in range(12):
        step = np.linalg.solve(jacobian(f, z), f(z))
        z = z - step
        if np.abs(step).max() < 1e-12:
            return z
    raise AssertionError("Newton's method does not converge")


def spectrum(Omega, guess, machine=COUPLED):
    """The symmetric orbit near a guess and the multipliers of its half map."""
    x = newton(lambda x: half(np.r_[x, x], Omega, machine), guess)
    J = jacobian(lambda z: half(z, Omega, machine), np.r_[x, x])
    return x, eigvals(-J[:, :4], J[:, 4:])


def secant(f, a, b):
    fa, fb = f(a), f(b)
    for _ in range(8):
        a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
        if abs(b - a) < 1e-12:
            return b
        fb = f(b)
    raise AssertionError("the secant rule does not converge")


def minus_one(multipliers):
    return float(multipliers.real.min()) + 1.0


def on_circle(multipliers):
    return float(np.abs(multipliers[np.abs(multipliers.imag) > 1e-3]).max()) - 1.0


@pytest.mark.parametrize(
    ("value", "condition", "fast"),
    [
        *((value, minus_one, True) for value in BREAKINGS),
        *((value, on_circle, fast) for value, fast in zip(NEIMARK_SACKER, (True, False))),
    ],
)
def test_integrated_multipliers(value, condition, fast):
    guess = np.array(COUPLED.symmetric_orbit(fast=fast, frequency=value).nodes[0])

    def at(Omega):
        nonlocal guess
        guess, multipliers = spectrum(Omega, guess)
        return condition(multipliers)

    near = 1e-6 if value > 1.028 else 1e-5  # the slow side begins at the fold, 1.02804
    assert secant(at, value - near, value + near) == pytest.approx(value, abs=2e-11)


def integrated_fold(machine, value, inward):
    """The extremum of the frequency over the velocity B, from five integrated orbits through the fold."""
    near = [
        np.array(machine.symmetric_orbit(fast=fast, frequency=value + inward).nodes[0])
        for fast in (True, False)
    ]
    middle = 0.5 * (near[0] + near[1])
    rest, found = np.r_[middle[[0, 2, 3]], value], []
    for B in middle[1] + 2e-3 * np.arange(-2, 3):
        rest = newton(
            lambda q, B=B: half(np.tile([q[0], B, q[1], q[2]], 2), q[3], machine),
            rest,
        )
        found.append(rest[3])
    curve = np.polyfit(np.arange(-2, 3), found, 4)
    tops = np.roots(np.polyder(curve))
    return np.polyval(curve, tops[np.argmin(np.abs(tops))].real)


@pytest.mark.parametrize(("value", "inward"), [(FOLDS[0], 1e-6), (FOLDS[1], -1e-6)])
def test_integrated_folds(value, inward):
    assert integrated_fold(COUPLED, value, inward) == pytest.approx(value, abs=2e-11)


@pytest.mark.parametrize("value", VELOCITY_GRAZES)
def test_integrated_velocity_grazes(value):
    """The frequency at which w' and w'' vanish together inside the flight of the symmetric orbit."""

    def grazing(z):
        x, duration, Omega = z[:4], z[4], z[5]
        params = COUPLED.vector({"frequency": Omega})
        y = fly(params, x[0], duration, after_left(params, x))
        rates = right_side(params, -1)(x[0] / Omega + duration, y)
        return np.r_[half(np.r_[x, x], Omega), y[1] - y[3], rates[1] - rates[3]]

    x = np.array(COUPLED.symmetric_orbit(frequency=value).nodes[0])
    params = COUPLED.vector({"frequency": value})
    instants = np.linspace(0.3, 2.8, 51)
    rates = []
    for instant in instants:
        y = fly(params, x[0], instant, after_left(params, x))
        rates.append(y[1] - y[3])
    z = newton(grazing, np.r_[x, instants[np.argmax(rates)], value + 2e-6])
    assert z[5] == pytest.approx(value, abs=2e-11)
    assert 0.3 < z[4] < 2.8


@pytest.mark.parametrize("value", WALL_GRAZES)
def test_integrated_wall_grazes(value):
    """The frequency at which the sliding motion, which knows no impact, just reaches the walls."""

    def touching(z):
        psi, v, v_rate, Omega = z
        params = COUPLED.vector({"frequency": Omega})
        eps = params[3]
        rate = v_rate / (1 + eps)
        q1, p1, q2, p2 = fly(
            params, psi, np.pi / Omega, [(v + eps) / (1 + eps), rate, (v - 1) / (1 + eps), rate]
        )
        return np.array([p1 - p2, q1 - q2 + 1.0, q1 + eps * q2 + v, p1 + eps * p2 + v_rate])

    nodes = COUPLED.sliding_orbit(frequency=value).nodes
    turn = nodes[np.argmax(nodes[:, 1])]
    z = newton(touching, np.r_[turn[[0, 2, 3]], value + 2e-6])
    assert z[3] == pytest.approx(value, abs=2e-11)


# ---------------------------------------------------------------------- the branches
def test_the_symmetric_response_from_graze_to_graze():
    """Real from graze to graze, virtual in between; folds, breakings, Neimark-Sacker points and borders as integrated."""
    graph = cv.diagram(
        COUPLED.orbit("LR", frequency=1.01), over="frequency", within=WITHIN, depth=0, virtual=True
    )
    pieces = [b for b in graph if b.description["word"] == "LR" and b.description["symmetric"]]
    real, virtual = (
        sorted((branch for branch in pieces if branch.real == kind), key=lambda b: b.range)
        for kind in (True, False)
    )
    assert len(real) == len(virtual) == 2
    below, above = real
    assert below.range == pytest.approx((FOLDS[0], VELOCITY_GRAZES[0]), abs=1e-11)
    assert above.range == pytest.approx((VELOCITY_GRAZES[1], FOLDS[1]), abs=1e-11)
    for branch, i in ((below, 0), (above, 1)):
        assert sorted(branch.values[[0, -1]]) == pytest.approx(
            sorted((VELOCITY_GRAZES[i], WALL_GRAZES[i])), abs=1e-11
        )
    assert virtual[0].range == pytest.approx(WALL_GRAZES, abs=1e-11)
    assert virtual[1].range == pytest.approx(VELOCITY_GRAZES, abs=1e-11)

    def values(kind):
        labels = {branch.label for branch in pieces}
        return sorted(p.value for p in graph.of_kind(kind) if p.branch in labels)

    assert values("fold") == pytest.approx(FOLDS, abs=1e-11)
    assert values("symmetry-breaking") == pytest.approx(BREAKINGS, abs=1e-11)
    assert values("neimark-sacker") == pytest.approx(NEIMARK_SACKER, abs=1e-10)
    assert below.stable_intervals() == [pytest.approx((FOLDS[0], BREAKINGS[0]), abs=1e-11)]
    assert above.stable_intervals() == [pytest.approx((BREAKINGS[1], NEIMARK_SACKER[0]), abs=1e-10)]
    for point in (
        p for p in graph.special.values() if p.kind in BORDERS and p.branch in (below.label, above.label)
    ):
        assert point.replay < 1e-6


def test_the_linear_regime_leads_to_all_others():
    """From the absorber stuck below resonance, by borders alone: stick-slip, sliding, impacts, and the linear regime above."""

    def left_over(omega):  # friction that the linear response with the mass 1 + eps does not need
        drag = 1j * 0.006 * omega
        response = 0.006 * 2.47 * abs(1.0 + drag) / abs(1.0 - 1.006 * omega**2 + drag)
        return 0.5 * 0.211 - omega**2 * response

    slips = brentq(left_over, 0.9, 0.97, xtol=1e-15), brentq(left_over, 1.03, 1.1, xtol=1e-15)
    graph = cv.diagram(COUPLED.orbit("", frequency=0.93), over="frequency", within=(0.92, 1.09), depth=2)
    stuck = [branch for branch in graph if branch.description["word"] == ""]
    assert sorted(branch.range for branch in stuck) == [
        pytest.approx((0.92, slips[0]), abs=1e-11),
        pytest.approx((slips[1], 1.09), abs=1e-11),
    ]
    words = {branch.description["word"] for branch in graph if branch.real and branch.stable.any()}
    assert {"", "ss", "tt"} <= words and words & {"LR", "RL"}
    assert sorted(p.value for p in graph.of_kind("fold"))[:1] == pytest.approx([FOLDS[0]], abs=1e-11)
