"""Numbers of modulated motions: a periodic one has no band; a modulated one as a dense sampling of the simulation has it."""

import numpy as np
import pytest

from contvines.loci.regions import Region
from orbits import Coupled, Machine
from orbits.attractors import find_attractor
from orbits.attractors.attractor import modulation
from orbits.attractors.sweeping import sweep
from orbits.simulation import simulate
from orbits.symbols import cos

MACHINE = Coupled(
    mass_ratio=0.01, restitution=0.7, friction=0.155, gravity=0.194, damping=2.0, excitation=1.0
)


def of(parameters, periods=64):
    found = find_attractor(MACHINE, observed=False, **parameters)
    return found, modulation(found.follow(periods))


def test_a_periodic_motion_has_no_band():
    found, seen = of({"forcing": 10.0, "frequency": 0.9})
    assert found.recurrent
    top = found.found.root().measure("max_abs_q1")  # of the closed form
    assert (seen.low, seen.mean, seen.high) == pytest.approx((top, top, top), rel=2e-3)
    assert seen.silent == 0.0 and seen.kind == ""


def test_a_modulated_motion_is_that_of_a_dense_sampling():
    found, seen = of({"forcing": 10.0, "frequency": 1.0})
    assert not found.recurrent
    run = simulate(MACHINE, found.state, periods=64.0, events=None, forcing=10.0, frequency=1.0)
    sample = run.sample(per_period=1000)
    tops = [np.abs(part).max() for part in np.array_split(sample.cavity, 64)]
    assert seen.high == pytest.approx(max(tops), rel=5e-3) and seen.low == pytest.approx(min(tops), rel=5e-3)
    assert seen.mean == pytest.approx(np.mean(tops), rel=5e-3)
    assert seen.low < seen.mean < seen.high


def test_a_steady_response_is_not_modulated_by_what_tables_do_not_show():
    """Of a light absorber that wanders in its cavity: 2.0000 to 2.0005 is 2, whatever impacts do; impacts that come and go are told."""
    from orbits.attractors.attractor import Modulation

    assert Modulation(2.0, 2.0002, 2.0005, 0.0).kind == ""
    assert Modulation(2.0, 2.002, 2.005, 0.0).kind == "weak modulation"
    assert Modulation(2.0, 2.0002, 2.0005, 0.4).kind == "strong modulation"


def test_what_sticks_moves_with_its_cavity_once_a_forcing_period():
    found = find_attractor(MACHINE, observed=False, forcing=0.1, frequency=0.9, friction=0.9)
    assert (found.kind, found.periods) == ("stuck", 1)


def test_impacts_that_stop_and_begin_again_make_it_strong():
    from orbits.attractors.attractor import Modulation

    assert Modulation(1.0, 2.0, 3.0, 0.4).kind == "strong modulation"
    assert Modulation(1.0, 2.0, 3.0, 1.0).kind == "weak modulation"  # no impacts at all


def test_sweeps_and_charts_tell_of_modulation_as_a_dense_sampling_has_it():
    (row,) = sweep(MACHINE, "frequency", [1.0], forcing=10.0)
    run = simulate(MACHINE, row.detail.state, periods=512.0, events=None, forcing=10.0, frequency=1.0)
    cavity = np.abs(run.sample(per_period=200).cavity[: 512 * 200])
    tops = cavity.reshape(512, 200).max(axis=1)
    band = [row.measures[f"modulated_{name}"] for name in ("low", "mean", "high")]
    assert band == pytest.approx([tops.min(), tops.mean(), tops.max()], rel=5e-3)
    assert row.modulation == "chaotic weak modulation"  # impacts in every period: neighbours part
    steady = sweep(MACHINE, "frequency", [0.9], forcing=10.0)[0]
    assert steady.modulation == "" and np.isnan(steady.measures["modulated_mean"])
    problem = find_attractor(MACHINE, forcing=10.0, frequency=0.9).found.problem("frequency")
    (met,) = problem.simulated_attractors(1.0)
    assert met["modulation"] == row.modulation and met["share"] == 1.0
    assert met["modulated_mean"] == pytest.approx(band[1], rel=5e-3)
    name = Region((1.0, 10.0), 0.1, [met]).words
    assert name == ["chaotic weak modulation"]


def test_a_beating_page_has_the_band_of_its_two_frequencies():
    """x'' + x = cos(w t) from rest: x = (cos(w t) - cos t)/(1 - w^2), which beats between 0 and 2/|1 - w^2|."""
    w = float(np.sqrt(0.8))
    machine = Machine(
        name="beating", states=("x", "v"), parameters={"w": w}, phase_rate="w",
        motion=lambda state, phase, p, contact: (state.v, cos(phase) - state.x), contacts=[],
    )  # fmt: skip
    (row,) = sweep(machine, "w", [w])
    low, mean, high = (row.measures[f"modulated_{name}"] for name in ("low", "mean", "high"))
    assert (
        high == pytest.approx(2.0 / 0.2, rel=0.01) and low < 0.3 * high and row.modulation.startswith("weak")
    )


def test_a_chaotic_page_says_so():
    """Duffing's oscillator with two wells, damping 0.15 and force 0.3 cos(t): its neighbours part (F. C. Moon and P. J. Holmes,
    Journal of Sound and Vibration 65 (1979) 275)."""
    machine = Machine(
        name="two_wells", states=("x", "v"), parameters={"w": 1.0}, phase_rate="w",
        motion=lambda state, phase, p, contact: (
            state.v, state.x - state.x**3 - 0.15 * state.v + 0.3 * cos(phase)
        ), contacts=[],
    )  # fmt: skip
    (row,) = sweep(machine, "w", [1.0])
    assert row.modulation == "chaotic weak modulation"
