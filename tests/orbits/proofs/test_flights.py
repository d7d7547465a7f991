"""The proofs' flights, against the equations of motion in thirty digits; what they say of walls."""

import mpmath as mp
import pytest

from orbits.proofs.balls import ball, precision
from orbits.proofs.equations import Motif

pytestmark = pytest.mark.slow

COUPLED = {
    "forcing": 2.1, "damping": 0.8, "restitution": 0.7, "excitation": 0.6, "friction": 0.4,
    "gravity": 0.3, "mass_ratio": 0.15, "frequency": 0.97,
}  # fmt: skip
CAVITY = {
    "amplitude": 0.8, "slope": 0.13, "gravity": 0.31, "mass_ratio": 0.02, "frequency": 1.1,
    "restitution_left": 0.7, "restitution_right": 0.6, "friction_left": 0.3, "friction_right": 0.5,
    "distance_left": 1.25, "distance_right": 0.9,
}  # fmt: skip


def numbers(given):
    return {name: ball(repr(value)) for name, value in given.items()}


def coupled(mode, psi, q, ahead):
    """w, v and their rates, and v'': forced oscillator and absorber with sin Psi and cos Psi as states, by matrix exponential."""
    G, lam, chi, mu, g, eps, Omega = (
        mp.mpf(str(COUPLED[n]))
        for n in ("forcing", "damping", "excitation", "friction", "gravity", "mass_ratio", "frequency")
    )
    matrix = mp.zeros(7)
    matrix[0, 1] = matrix[2, 3] = 1
    matrix[4, 5], matrix[5, 4] = Omega, -Omega
    row = [-1, -eps * lam, 0, 0, eps * G, eps * G * chi * eps * lam * Omega, -eps * mu * g * mode]
    for j, entry in enumerate(row):
        matrix[1, j] = entry if mode else entry / (1 + eps)
        matrix[3, j] = 0 if mode else entry / (1 + eps)
    matrix[3, 6] += mu * g * mode
    state = mp.matrix([*q, mp.sin(psi), mp.cos(psi), 1])
    q1, p1, q2, p2 = (mp.expm(matrix * ahead) * state)[:4]
    force = (row[:6] * (mp.expm(matrix * ahead) * state)[:6, 0] for row in [mp.matrix([row[:6]])])
    return q1 - q2, p1 - p2, q1 + eps * q2, p1 + eps * p2, next(force)[0]


@pytest.mark.parametrize("mode", [-1, 0, 1])
@pytest.mark.parametrize("letter", ["L", "s"])
def test_flights_of_the_coupled_machine(mode, letter):
    with mp.workdps(30), precision(110):
        eps = mp.mpf("0.15")
        psi, v, v_rate = mp.mpf("0.9"), mp.mpf("0.3"), mp.mpf("-0.2")
        w = mp.mpf(1) if letter == "L" else mp.mpf("0.25")
        w_rate = mp.mpf("-0.4") if letter == "L" and mode else mp.mpf(0)
        q = [
            (v + eps * w) / (1 + eps),
            (v_rate + eps * w_rate) / (1 + eps),
            (v - w) / (1 + eps),
            (v_rate - w_rate) / (1 + eps),
        ]
        node = [
            ball("0.9"),
            ball("0.2" if w_rate else "-0.2") if letter == "L" else ball("0.25"),
            ball("0.3"),
            ball("-0.2"),
        ]
        flight = (
            Motif("coupled", ("L",), (-1,), 1, False, False)
            .flights(numbers(COUPLED))
            .launch(letter, mode, node)
        )
        for ahead in ("0", "0.6", "2.3"):
            expected = coupled(mode, psi, q, mp.mpf(ahead))
            here = flight(ball("0.9") + ball(ahead) * ball("0.97"))
            found = (here.w, here.w1, here.v, here.v1, here.push)
            for one, other in zip(found, expected):
                assert abs(float(one - ball(mp.nstr(other, 28)))) < 1e-24
            step = mp.mpf("1e-8")
            rate = (
                coupled(mode, psi, q, mp.mpf(ahead) + step)[4]
                - coupled(mode, psi, q, mp.mpf(ahead) - step)[4]
            ) / (2 * step)
            assert abs(float(here.push1) - rate) < 1e-13


@pytest.mark.parametrize("mode", [-1, 0, 1])
@pytest.mark.parametrize("letter", ["L", "R", "t"])
def test_flights_of_an_inclined_cavity(mode, letter):
    """w'' = -C Omega^2 sin Psi - b - s a_s by quadrature; walls at their own distances."""
    with mp.workdps(30), precision(110):
        p = {name: mp.mpf(str(value)) for name, value in CAVITY.items()}
        weight, C, Omega = (1 + p["mass_ratio"]) * p["gravity"], p["amplitude"], p["frequency"]
        b = weight * mp.sin(p["slope"])
        a = weight * mp.cos(p["slope"]) * p["friction_left" if mode > 0 else "friction_right"]
        psi = mp.mpf("0.7")
        start = {"L": p["distance_left"], "R": -p["distance_right"], "t": mp.mpf("0.35")}[letter]
        B = mp.mpf("0.35") if letter != "t" else C * Omega * mp.cos(psi)
        flight = (
            Motif("cavity", ("L",), (-1,), 1, False, False)
            .flights(numbers(CAVITY))
            .launch(letter, mode, [ball("0.7"), ball("0.35")])
        )
        t = mp.mpf("1.4")

        def acceleration(x):
            return (-C * Omega**2 * mp.sin(psi + Omega * x) - b - mode * a) if mode else mp.mpf(0)

        speed = (C * Omega * mp.cos(psi) - B if mode else 0) + mp.quad(acceleration, [0, t])
        place = (
            start
            + (C * Omega * mp.cos(psi) - B if mode else 0) * t
            + mp.quad(lambda x: (t - x) * acceleration(x), [0, t])
        )
        here = flight(ball("0.7") + ball("1.1") * ball("1.4"))
        assert abs(float(here.w) - place) < 1e-15 and abs(float(here.w1) - speed) < 1e-15
        assert abs(float(here.push) - (-C * Omega**2 * mp.sin(psi + Omega * t) - b)) < 1e-15
        assert abs(float(here.v1) - C * Omega * mp.cos(psi + Omega * t)) < 1e-15
