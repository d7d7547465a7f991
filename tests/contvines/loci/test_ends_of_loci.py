"""Where a locus ends, in closed form, and with which digits that is told."""

import numpy as np
import pytest

import contvines as cv
import orbits
from tests.contvines.loci.systems import cusp


def test_a_table_has_no_digits_that_tell_a_locus_from_its_own_point():
    flow = cv.FlowProblem(cusp, [-1.0], {"b": -0.5, "a": 1.0})
    chart = cv.chart(cv.diagram(flow, over="b", within=(-1, 1)), "a", (0, 2))
    assert chart.points["CP1"].value == pytest.approx((0.0, 1 / 3), abs=1e-10)
    rows = [line.split() for line in str(chart).splitlines()]
    assert next(row for row in rows if row[:1] == ["LP1"])[3] == "0.3333..2"


@pytest.mark.slow
def test_a_doubling_of_doubled_motions_ends_where_they_are_symmetric_and_shorter_at_once():
    """Twelve impacts, turns and sticks in two periods become six in one, of which the second half is the mirror image of the first."""
    cavity = orbits.Cavity(
        restitution=0.11648942401002599,
        friction=0.39350823866587725,
        gravity=0.31216513931655915,
        distance_left=1.1248846775229775,
        distance_right=0.8293088140227801,
        frequency=0.7385019569589696,
    )
    start = cavity.attractor(amplitude=1.1566760863521892)
    graph = cv.diagram(
        start.orbit, over="amplitude", within=(0.7566760863521892, 1.5566760863521893), depth=2, virtual=True
    )
    doubling = next(p for p in graph.of_kind("period-doubling") if str(p.orbit.word) == "LtLRtRLtLRtR")
    locus = cv.locus(doubling, over="frequency", within=(0.59, 0.89))
    flights = locus.orbit(0).durations.reshape(4, 3)
    assert locus.values[0][1] > 0.6 and np.ptp(flights, axis=0) == pytest.approx(0.0, abs=1e-9)
    assert np.ptp(locus.orbit(len(locus) // 2).durations.reshape(4, 3), axis=0).max() > 1e-3
