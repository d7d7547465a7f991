"""The absorber on its oscillator, frequency against forcing: where the response becomes modulated, in many digits; where the absorber begins to move, in closed form."""

import numpy as np
import pytest

import contvines as cv
from contvines.loci.codimension_two import find
from tests.machines import COUPLED, STRONG
from tools.fuzz.many_digits import exact

pytestmark = pytest.mark.slow


def test_the_onset_of_modulation_in_many_digits():
    """The motion solved anew beside the one that is claimed: a pair is on the circle; where it is a double multiplier 1, or where another one is 1, so is that."""

    def solved(orbit):
        """By how much the nearest pair is off the circle, and the characteristic polynomial."""
        found = exact(orbit)
        assert abs(found.shift) < 1e-13 and found.moved < 1e-12
        pairs = found.multipliers[found.multipliers.imag > 1e-3]
        return np.abs(np.abs(pairs) - 1.0).min(initial=1.0), np.poly(found.multipliers)

    graph = cv.diagram(COUPLED.orbit("LR", frequency=1.02), over="frequency", within=(0.985, 1.03), depth=0)
    locus = cv.locus(graph["NS1"], over="forcing", within=(0.5, 4.0), bounds=(0.92, 1.09))
    assert len(locus) > 20
    for i in np.linspace(4, len(locus) - 5, 4).astype(int):
        assert solved(locus.orbit(int(i)))[0] < 1e-11
    points = {point.kind: point for _, point in find(locus)}
    _, polynomial = solved(points["resonance-1-1"].orbit)
    assert np.polyval(polynomial, 1.0) == pytest.approx(0.0, abs=1e-12)
    assert np.polyval(np.polyder(polynomial), 1.0) == pytest.approx(0.0, abs=1e-12)
    off, polynomial = solved(points["fold-neimark-sacker"].orbit)
    assert off < 1e-11 and np.polyval(polynomial, 1.0) == pytest.approx(0.0, abs=1e-12)


def forcing_that_moves_it(frequency):
    """The oscillator with the absorber stuck is linear: its largest acceleration is mu g."""
    eps = STRONG["mass_ratio"]
    response = (
        eps * np.hypot(1.0, eps * frequency) / np.hypot(1.0 - (1.0 + eps) * frequency**2, eps * frequency)
    )
    return STRONG["friction"] * STRONG["gravity"] / (frequency**2 * response)


def test_the_border_of_the_stuck_absorber_has_a_locus_in_closed_form():
    """Stick-slip up to the border at which the slips vanish, and the absorber stuck beyond."""
    graph = cv.diagram(
        COUPLED.attractor(frequency=1.06).orbit, over="frequency", within=(1.055, 1.09), depth=1
    )
    point = next(s for s in graph.special.values() if s.kind == "stick")
    assert forcing_that_moves_it(point.value) == pytest.approx(2.47, rel=1e-9)
    locus = cv.locus(point, over="forcing", within=(1.0, 4.0), bounds=(1.02, 1.2))
    assert len(locus) > 5 and locus.real.all()
    for frequency, forcing in locus.values:
        assert forcing == pytest.approx(forcing_that_moves_it(frequency), rel=1e-9)
