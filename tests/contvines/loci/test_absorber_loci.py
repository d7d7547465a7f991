"""Loci of the reduced absorber against closed forms and against diagrams in one parameter."""

import numpy as np
import pytest

import contvines as cv
from orbits import Cavity
from tests.machines import ABSORBER, STRONG


def closed_form(kind, **changed):
    """Amplitude of the fold or symmetry breaking of the symmetric orbit with two impacts: MODEL section 4."""
    m = {**STRONG, **changed}
    a = (1.0 + m["mass_ratio"]) * m["friction"] * m["gravity"]
    R, H = (1.0 - m["restitution"]) / (1.0 + m["restitution"]), 0.5 * np.pi * a
    below = np.pi**2 + 4.0 * R**2 if kind == "fold" else np.pi**2 - 4.0
    beta = (2.0 * np.pi - 4.0 * R * H) / below
    return np.hypot(1.0 - 0.5 * np.pi * beta, R * beta + H)


def follows_its_closed_form(point, kind, over, within):
    locus = cv.locus(point, over=over, within=within)
    assert locus.kind == kind and locus.parameters == ("amplitude", over)
    assert len(locus) > 10 and locus.real.all()
    for p, q in locus.values:
        assert p == pytest.approx(closed_form(kind, **{over: q}), abs=1e-12)


BOTH = {"LP1": "fold", "SB1": "symmetry-breaking"}


@pytest.mark.parametrize("label", BOTH)
@pytest.mark.parametrize(
    "over, within", [("friction", (0.05, 0.9)), ("gravity", (0.05, 0.6)), ("restitution", (0.3, 0.95))]
)
def test_fold_and_symmetry_breaking_are_their_closed_forms(absorber, label, over, within):
    follows_its_closed_form(absorber[label], BOTH[label], over, within)


@pytest.mark.slow
def test_loci_of_a_declared_machine_are_their_closed_forms():
    """Its kernels are plain Python."""
    pytest.importorskip("heyoka")
    from tools.pages.pages import page

    orbit = page("absorber").orbit("LR", amplitude=0.55)
    graph = cv.diagram(orbit, over="amplitude", within=(0.2, 0.8), depth=0)
    for label, kind in BOTH.items():
        follows_its_closed_form(graph[label], kind, "friction", (0.35, 0.65))


def test_velocity_graze_and_real_period_doubling_are_those_of_diagrams(absorber):
    loci = {
        label: cv.locus(absorber[label], over="friction", within=(0.25, 0.85)) for label in ("VG1", "PD1")
    }
    for friction in np.linspace(0.26, 0.84, 20):
        orbit = ABSORBER.changed(friction=float(friction)).symmetric_orbit(amplitude=0.7)
        other = cv.diagram(orbit, over="amplitude", within=(0.6, 1.25), depth=1)
        for label, locus in loci.items():
            special = other[label]
            assert special.kind == absorber[label].kind and special.real
            assert special.problem.word.canonical() == locus.problem.base.word.canonical()
            assert locus.at(friction) == pytest.approx([special.value], abs=1e-10)


def test_a_border_that_jumps_is_followed_by_its_smooth_margin(absorber):
    # a stick becomes a turn: the time to the slip jumps there, the duration of the stick passes zero
    locus = cv.locus(absorber["ST2"], over="friction", within=(0.3, 0.7))
    for said, end in zip(locus.ended, (0.3, 0.7), strict=True):
        assert said.startswith(f"reaches the end of the interval, friction = {end}")


def test_a_border_whose_first_margin_only_touches_zero_is_followed_by_another():
    """An impact that loses its speed: the distance kept from the wall grows with the square of what is missing.

    Without friction time has no unit but the period, so that the amplitude at which it happens is the same at all frequencies.
    """
    cavity = Cavity(
        restitution=0.148,
        friction=0.0,
        gravity=0.277,
        distance_left=0.758,
        distance_right=0.918,
        mass_ratio=0.0,
    )
    graph = cv.diagram(cavity.attractor(amplitude=1.15).orbit, over="amplitude", within=(0.73, 1.53), depth=1)
    border = next(p for p in graph.of_kind("wall-graze") if str(p.orbit.word) == "LLRR")
    locus = cv.locus(border, over="frequency", within=(0.8, 1.2))
    assert len(locus) < 100 and locus.values[:, 0] == pytest.approx(border.value, abs=1e-10)
    assert locus.values[[0, -1], 1] == pytest.approx([0.8, 1.2])
