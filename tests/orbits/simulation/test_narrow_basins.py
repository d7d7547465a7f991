"""Stable orbits to which only starts very near return: deviations grow a thousandfold on the way before they shrink, or a fold is near."""

import mpmath as mp
import numpy as np
import pytest

from orbits import Absorber
from orbits.simulation import replay

pytestmark = pytest.mark.slow

R, AMPLITUDE, PERIODS = 0.6134455719320618, 1.249753219146763, 8
WORD = "LRRLRRLRRLRRLRLRRLRRLRR"
NODES = [
    [4.9755196858787105, 1.566737755212909], [7.819484382878975, -0.8915615737740383],
    [10.146140138911175, -0.9672106436406289], [12.025692296764145, 2.322118801875774],
    [13.636003467450202, -0.4557174349498191], [15.514857789686308, -1.6993719719570852],
    [17.542824661927042, 1.5687687342387802], [20.382826664528515, -0.8867050734802628],
    [22.6177114611974, -1.0894419856434552], [24.47874745927266, 2.268657338363204],
    [26.169683220471594, -0.3656378469195036], [27.9172089751715, -1.6648861295302526],
    [30.10613710878067, 1.5416583295298503], [32.99725036668749, -0.966950835248281],
    [37.093626846074585, 2.2511157565647455], [38.79069042394827, -0.4512007816026456],
    [40.60695540142193, -1.6847851256750601], [42.6809002604272, 1.570196386725822],
    [45.51725009302772, -0.8909705798613667], [47.84284799199683, -0.9707700879655248],
    [49.7214896618181, 2.320852802946065], [51.33389077769741, -0.45277603023111485],
    [53.20849034562605, -1.6990263805355201],
]  # fmt: skip


def rounds(psi, rate, times):
    """Phases and speeds at the impacts in fifty digits: flights w'' = -C sin Psi from wall to wall, times w' = -r w' there."""
    phases = [node[0] for node in NODES] + [NODES[0][0] + 2 * np.pi * PERIODS]
    found = [(psi, rate)]
    for k in range(times * len(WORD)):
        i = k % len(WORD)
        here, there = (1 if WORD[j % len(WORD)] == "L" else -1 for j in (i, i + 1))

        def gap(t, psi=psi, rate=rate, here=here, there=there):
            turned = mp.sin(psi + t) - mp.sin(psi) - t * mp.cos(psi)
            return here + rate * t + AMPLITUDE * turned - there

        t = mp.findroot(gap, mp.mpf(phases[i + 1] - phases[i]))
        rate = -mp.mpf(R) * (rate + AMPLITUDE * (mp.cos(psi + t) - mp.cos(psi)))
        psi += t
        found.append((psi, rate))
    return found


def test_such_an_orbit_is_said_to_return():
    machine = Absorber(restitution=R, friction=0.0, gravity=0.4648360951073012, mass_ratio=0.0)
    orbit = machine.orbit(WORD, periods=PERIODS, guess=NODES, amplitude=AMPLITUDE)
    with mp.workdps(50):
        first = mp.mpf(float(orbit.nodes[0, 0]))
        rate = AMPLITUDE * mp.cos(first) - mp.mpf(float(orbit.nodes[0, 1]))  # B+ = v' - w'+
        own = rounds(first, rate, 2)[len(WORD) :]
        moved = rounds(own[0][0], own[0][1] * (1 + mp.mpf("1e-10")), 2)
        still = rounds(*own[0], 2)
        gaps = [float(max(abs(a - c), abs(b - d))) for (a, b), (c, d) in zip(moved, still)]
    assert (
        max(gaps) > 1e3 * gaps[0] and gaps[-1] < 1e-3 * gaps[0]
    )  # it grows on the way, and is gone after two rounds
    assert np.abs(orbit.multipliers).max() < 1e-3
    assert replay(orbit, thorough=True).returned is True
