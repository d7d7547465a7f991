"""A point of codimension two of the absorber against equations written anew, solved in many digits, and against simulation."""

import mpmath as mp
import numpy as np
import pytest

import contvines as cv
from contvines.loci.codimension_two import find
from orbits import Absorber
from orbits.attractors import find_attractor

MACHINE = {"restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": 0.006}


@pytest.fixture(scope="module")
def meeting():
    """Where the second doubling of the motion with two turns ends at the border at which a turn meets a wall."""
    graph = cv.diagram(
        Absorber(**MACHINE).symmetric_orbit(amplitude=0.55), over="amplitude", within=(0.2, 1.3)
    )
    locus = cv.locus(graph["PD2"], over="friction", within=(0.3, 0.9), bounds=(0.2, 1.3))
    (found,) = [point for _, point in find(locus) if point.kind == "border-flip"]
    return found


def flight(start, mode, first, second, psi, C, mu):
    """(w, w') at phase psi after an event: MODEL section 2, frequency 1."""
    a = (1 + mp.mpf("0.006")) * mu * mp.mpf("0.211")
    if start in "LR":
        w0, rate0 = (1 if start == "L" else -1), C * mp.cos(first) - second
    else:
        w0, rate0 = second, mp.mpf(0)
    d = psi - first
    rate = rate0 + C * (mp.cos(psi) - mp.cos(first)) - mode * a * d
    w = w0 + C * (mp.sin(psi) - mp.sin(first)) + (rate0 - C * mp.cos(first)) * d - mode * a * d * d / 2
    return w, rate


def elementary(start, mode, arrival, x, y, C, mu):
    w, rate = flight(start, mode, x[0], x[1], y[0], C, mu)
    if arrival in "LR":
        return [w - (1 if arrival == "L" else -1), y[1] - C * mp.cos(y[0]) - mp.mpf("0.76") * rate]
    return [rate, w - y[1]]


def test_border_flip_in_25_digits(meeting):
    problem = meeting.problem
    events, modes = problem.word.events, problem.word.modes
    n = len(events)
    j = meeting.margins[0] // 4  # the turn that meets the wall
    side = np.sign(meeting.u[2 * j + 1])

    def system(*v):
        x = [(v[2 * i], v[2 * i + 1]) for i in range(n)]
        C, mu = v[2 * n], v[2 * n + 1]
        x.append((x[0][0] + 2 * mp.pi * problem.periods, x[0][1]))
        equations = []
        monodromy = mp.eye(2)
        for i in range(n):
            arrival = events[(i + 1) % n]

            def g(a, b, c, d, i=i, arrival=arrival):
                return elementary(events[i], modes[i], arrival, (a, b), (c, d), C, mu)

            here = (*x[i], *x[i + 1])
            value = g(*here)
            equations += value
            h = mp.mpf(10) ** -14
            J = mp.matrix(2, 4)
            for k in range(4):
                up, down = list(here), list(here)
                up[k] += h
                down[k] -= h
                for row, (p, m) in enumerate(zip(g(*up), g(*down))):
                    J[row, k] = (p - m) / (2 * h)
            monodromy = -(J[:, 2:4] ** -1) * J[:, 0:2] * monodromy
        equations.append(mp.det(monodromy + mp.eye(2)))
        equations.append(x[j][1] - side)
        return equations

    with mp.workdps(30):
        start = [mp.mpf(float(value)) for value in (*meeting.u, *meeting.value)]
        exact = mp.findroot(system, start, tol=1e-20, maxsteps=5)
    assert float(exact[2 * n]) == pytest.approx(meeting.value[0], abs=1e-11)
    assert float(exact[2 * n + 1]) == pytest.approx(meeting.value[1], abs=1e-11)


def test_border_flip_by_simulation_on_its_sides(meeting):
    C, mu = meeting.value

    def settles(amplitude, friction):
        found = {}
        for w in (0.0, 0.3, -0.5, 0.8):
            motion = find_attractor(
                Absorber(**MACHINE), {"w": w}, amplitude=amplitude, max_period=8, friction=friction
            )
            found[motion.periods] = motion
        return found

    # below the doubling the motion of two forcing periods without that impact is among what is settled on
    below = settles(C - 0.004, mu + 0.02)
    assert any(p == 2 and m.word is not None and m.impacts == 4 for p, m in below.items())
