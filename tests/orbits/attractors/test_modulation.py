"""Numbers of modulated motions: a periodic one has no band; a modulated one as a dense sampling of the simulation has it."""

import numpy as np
import pytest

from contvines.loci.regions import Region
from orbits import Coupled, Machine
from orbits.attractors import find_attractor
from orbits.attractors.attractor import Modulation, modulation
from orbits.attractors.sweeping import sweep
from orbits.symbols import cos

MACHINE = Coupled(
    mass_ratio=0.01, restitution=0.7, friction=0.155, gravity=0.194, damping=2.0, forcing=10.0
)  # fmt: skip


@pytest.mark.parametrize(
    ("numbers", "kind"),
    [
        # of a light absorber that wanders in its cavity: 2.0000 to 2.0005 is 2, whatever impacts do
        ((2.0, 2.0002, 2.0005, 0.0), ""),
        ((2.0, 2.002, 2.005, 0.0), "weak modulation"),
        ((2.0, 2.0002, 2.0005, 0.4), "strong modulation"),  # impacts that stop and begin again
        ((1.0, 2.0, 3.0, 0.4), "strong modulation"),
        ((1.0, 2.0, 3.0, 1.0), "weak modulation"),  # no impacts at all
    ],
)
def test_what_tables_do_not_show_is_no_modulation(numbers, kind):
    assert Modulation(*numbers).kind == kind


def test_a_periodic_motion_has_no_band():
    found = find_attractor(MACHINE, frequency=0.9)
    seen = modulation(found.follow(64))
    top = found.found.root().measure("max_abs_q1")  # of the closed form
    assert (seen.low, seen.mean, seen.high) == pytest.approx((top, top, top), rel=2e-3)
    assert seen.silent == 0.0 and seen.kind == ""
    (row,) = sweep(MACHINE, "frequency", [0.9])
    assert row.modulation == "" and np.isnan(row.measures["modulated_mean"])


def test_what_sticks_moves_with_its_cavity_once_a_forcing_period():
    found = find_attractor(MACHINE, observed=False, forcing=0.1, frequency=0.9, friction=0.9)
    assert (found.kind, found.periods) == ("stuck", 1)


def test_sweeps_and_charts_tell_of_modulation_as_a_dense_sampling_has_it():
    (row,) = sweep(MACHINE, "frequency", [1.0])
    assert not row.detail.recurrent
    run = MACHINE.simulate(row.detail.state, periods=512.0, frequency=1.0)
    cavity = np.abs(run.sample(per_period=200).cavity[: 512 * 200])
    tops = cavity.reshape(512, 200).max(axis=1)
    band = [row.measures[f"modulated_{name}"] for name in ("low", "mean", "high")]
    assert band == pytest.approx([tops.min(), tops.mean(), tops.max()], rel=5e-3)
    assert row.modulation == "chaotic weak modulation"  # impacts in every period: neighbours part
    problem = find_attractor(MACHINE, frequency=0.9).found.problem("frequency")
    (met,) = problem.simulated_attractors(1.0)
    assert met["modulation"] == row.modulation and met["share"] == 1.0
    assert met["modulated_mean"] == pytest.approx(band[1], rel=5e-3)
    assert Region((1.0, 10.0), 0.1, [met]).words == ["chaotic weak modulation"]


def page(motion, w):
    """A forced page without contacts."""
    return Machine(
        name="page", states=("x", "v"), parameters={"w": w}, phase_rate="w", contacts=[],
        motion=lambda state, phase, p, contact: (state.v, motion(state, phase)),
    )  # fmt: skip


def test_a_beating_page_has_the_band_of_its_two_frequencies():
    """x'' + x = cos(w t) from rest: x = (cos(w t) - cos t)/(1 - w^2), which beats between 0 and 2/|1 - w^2|."""
    w = float(np.sqrt(0.8))
    (row,) = sweep(page(lambda s, phase: cos(phase) - s.x, w), "w", [w])
    assert row.measures["modulated_high"] == pytest.approx(2.0 / 0.2, rel=0.01)
    assert row.measures["modulated_low"] < 3.0 and row.modulation.startswith("weak")


def test_a_chaotic_page_says_so():
    """Duffing's oscillator with two wells, damping 0.15 and force 0.3 cos(t): its neighbours part (F. C. Moon and P. J. Holmes,
    Journal of Sound and Vibration 65 (1979) 275)."""
    machine = page(lambda s, phase: s.x - s.x**3 - 0.15 * s.v + 0.3 * cos(phase), 1.0)
    (row,) = sweep(machine, "w", [1.0])
    assert row.modulation == "chaotic weak modulation"
