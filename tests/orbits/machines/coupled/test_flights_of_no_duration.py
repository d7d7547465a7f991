"""Where a turn and a stick fall together the flight between them has no duration: its equations there, from Newton's law."""

import numpy as np
import pytest

from orbits import Coupled
from orbits.machines.names import usual
from orbits.machines.reference.machine import reference
from orbits.problem import OrbitProblem
from orbits.words import Word

NODE = (0.63, 0.274, -0.107, 1.728)  # of the turn: phase, w, v, v'


def newton(params, mode, psi, w, v, v_rate, w_rate=0.0):
    """w'' and v''."""
    G, Omega, lam, eps, _, mu, g, chi, slope = params
    q1, q1_rate = (v + eps * w) / (1.0 + eps), (v_rate + eps * w_rate) / (1.0 + eps)
    base = np.sin(psi) + chi * eps * lam * Omega * np.cos(psi)
    push = -q1 - eps * lam * q1_rate + eps * G * base
    return push - (1.0 + eps) * g * (mode * mu * np.cos(slope) + np.sin(slope)), push


def slope(function, x, i, step=1e-6):
    ahead, behind = list(x), list(x)
    ahead[i] += step
    behind[i] -= step
    return (function(ahead) - function(behind)) / (2.0 * step)


@pytest.mark.parametrize("plain", [True, False])
@pytest.mark.parametrize("duration", [0.0, 1e-13, -1e-12, 1e-7])
@pytest.mark.parametrize("parameter", ["frequency", "mass_ratio", "friction"])
def test_rows_of_a_short_flight_from_rest_to_rest(plain, duration, parameter):
    model, given = usual("coupled")
    model = Coupled(
        restitution=0.7,
        friction=0.4,
        gravity=0.3,
        mass_ratio=0.1,
        damping=0.8,
        frequency=0.97,
        excitation=0.6,
    )
    params = model.vector({**given, "forcing": 2.1})
    word = Word.parse("LtsRts")
    problem = OrbitProblem(model, word, 1, parameter, params)
    u = np.tile(NODE, (len(word), 1)) + 0.1 * np.arange(len(word))[:, None]
    u[1] = NODE
    u[2] = NODE
    u[2, 0] += duration * params[1]
    varying = list(model.parameter_names).index(parameter)
    data, work = problem.data, problem.workspace()
    linearise = reference("coupled").linearise if plain else problem.kernels.linearise
    linearise(data, u.ravel(), float(params[varying]), work)
    mode = word.modes[1]
    psi, w, v, v_rate = NODE

    def law(x, at=params):
        return newton(at, mode, *x)[0]

    along = (params[1], 0.0, v_rate, newton(params, mode, *NODE)[1], law(NODE))
    jerk = sum(slope(law, (*NODE, 0.0), i) * rate for i, rate in enumerate(along))
    by_node = [slope(law, NODE, i) for i in range(4)]
    by_node[0] -= 0.5 * jerk / params[1]
    A, D, Q, F = work.A[1, 0], work.D[1, 0], work.Q[1, 0], work.F[1, 0]
    assert pytest.approx(law(NODE) + 0.5 * jerk * duration, abs=1e-12) == F
    np.testing.assert_allclose(A, by_node, atol=1e-6)
    np.testing.assert_allclose(D, [0.5 * jerk / params[1], 0.0, 0.0, 0.0], atol=1e-6)
    assert pytest.approx(slope(lambda p: law(NODE, p), params, varying), abs=1e-6) == Q
