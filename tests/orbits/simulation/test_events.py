"""Events against forty digits and the limit of a geometric sequence; those of an integration are in `machines/test_inclined_cavity.py`."""

import mpmath as mp
import numpy as np
import pytest

from orbits import Absorber
from orbits.simulation import simulate


@pytest.mark.parametrize("rate", [2.0, 1.0, 1e-2, 1e-5, 1e-9])
def test_hits_have_full_relative_accuracy(rate):
    """A bounce off the wall that the shaking presses against, without friction: hit time against 40 digits."""
    C, psi = 0.7, 4.2  # -sin(4.2) > 0 pushes to w = +1
    machine = Absorber(restitution=0.9, friction=0.0, gravity=0.2)
    run = simulate(machine, {"phase": psi, "w": 1.0, "w_rate": -rate}, events=1, amplitude=C)
    with mp.workdps(40):
        p, slope = mp.mpf(psi), mp.mpf(rate) + C * mp.cos(psi)

        def gap(d):
            return C * (mp.sin(p + d) - mp.sin(p)) - slope * d

        if run.letters == "L":
            guess = 2 * rate / (-C * np.sin(psi)) if rate < 0.1 else run.phases[0] - psi
            d = mp.findroot(lambda x: gap(x) / x, guess)
            assert run.rows[0, 3] == pytest.approx(float(C * mp.cos(p + d) - slope), rel=2e-14)
        else:
            d = mp.findroot(lambda x: gap(x) + 2, run.phases[0] - psi)
        assert run.phases[0] == pytest.approx(psi + float(d), rel=4e-16, abs=1e-15)


def test_flight_after_a_slip():
    """From rest w' and w'' vanish together at the slip; the next event against 40 digits."""
    C, mu, g = 0.3, 0.5, 0.4
    machine = Absorber(restitution=0.8, friction=mu, gravity=g)
    run = simulate(machine, {"w": 0.2}, events=2, amplitude=C)
    assert run.letters[0] == "u"
    with mp.workdps(40):
        a = mp.mpf(mu) * mp.mpf(g)
        alpha = mp.asin(a / mp.mpf(C))
        assert run.phases[0] == pytest.approx(float(alpha), rel=4e-16)
        assert run.modes[0] == -1

        def speed(psi):  # in mode -, from w' = 0, w'' = 0 at alpha
            return C * (mp.cos(psi) - mp.cos(alpha)) + a * (psi - alpha)

        end = mp.findroot(lambda psi: speed(psi) / (psi - alpha) ** 2, run.phases[1])
        reach = mp.mpf("0.2") + mp.quad(speed, [alpha, end])
        assert reach > -1
        assert run.phases[1] == pytest.approx(float(end), rel=1e-15)
        assert run.rows[1, 2] == pytest.approx(float(reach), rel=1e-14)


def test_chatter_ends_in_contact_and_contact_in_release():
    """Impacts pile up at the limit of their geometric sequence; the wall lets go when the shaking turns round."""
    C, mu, g = 8.0, 0.2, 0.2
    machine = Absorber(restitution=0.3, friction=mu, gravity=g)
    run = simulate(machine, {"w_rate": 1.0}, periods=5, amplitude=C)
    holds = np.flatnonzero(run.codes == 5)
    assert len(holds) > 3
    assert "piled up" in run.ended
    for place in holds:
        phases = run.phases[:place][run.codes[:place] < 2][-8:]  # Aitken's limit of the impact phases
        last, middle, first = phases[-5], phases[-6], phases[-7]
        limit = last - (last - middle) ** 2 / ((last - middle) - (middle - first))
        assert run.phases[place] == pytest.approx(limit, abs=3e-7)
        assert abs(run.rows[place, 2]) == 1.0
        if place + 1 < len(run):
            assert run.letters[place + 1] == "u"
            wall = run.rows[place, 2]
            assert -C * np.sin(run.phases[place + 1]) * wall == pytest.approx(-mu * g, abs=1e-12)
            assert run.modes[place + 1] == -wall
