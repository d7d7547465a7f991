"""Numbers that pass zero, and the places where they do."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import contvines as cv
from contvines.bifurcation.locate import locate
from contvines.bifurcation.segment import Segment
from contvines.continuation.aims import (
    FLOW,
    MAP,
    MARGINS,
    NO_COLUMNS,
    SLOPE,
    SORTS,
    Aim,
    aim_at_multiplier,
    multiplier,
    probe,
)
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings

UNIT = st.floats(-3.0, 3.0)


@given(st.lists(UNIT, max_size=4), st.lists(st.tuples(UNIT, st.floats(0.01, 3.0)), max_size=2))
def test_multipliers_are_ranked_among_those_of_their_sort(real, pairs):
    """Against the definition, by sorting; every rank of every sort, of maps and flows."""
    spectrum = [complex(x) for x in real] + [z for a, b in pairs for z in (complex(a, b), complex(a, -b))]
    row = [x for z in spectrum for x in (z.real, z.imag)]
    for kind in (MAP, FLOW):
        size = abs if kind == MAP else (lambda z: z.real)
        sorts = {
            "plus": sorted((x for x in real), reverse=True),
            "minus": sorted((-x for x in real), reverse=True),
            "pair": sorted((size(complex(a, b)) for a, b in pairs), reverse=True),
        }
        for name, values in sorts.items():
            for rank, value in enumerate(values, 1):
                if kind == MAP:
                    value = math.log(value) if value > 0.0 else -1.0
                found = multiplier(row, len(spectrum), kind, SORTS[name], rank)
                assert found == pytest.approx(min(max(value, -1.0), 1.0), abs=1e-14)


def test_margins_that_do_not_apply_are_passed_over():
    aim = Aim(MARGINS, np.array([1, 2, 3]))
    assert probe(aim, [-5.0, np.nan, 0.25, np.inf], 0.0, 1.0) == 0.25
    assert probe(aim, [-5.0, np.nan, np.nan, np.inf], 0.0, 1.0) == 1.0


def circle(angle, engine):
    """The solution of u^2 + p^2 = 1 at an angle from the parameter's axis."""
    u, p = np.array([math.sin(angle)]), math.cos(angle)
    tangent = engine.unit(np.array([math.cos(angle), -math.sin(angle)]))
    found = engine.polish(
        u, p, engine.weights * tangent, float(engine.weights * tangent @ [u[0], p]), tangent
    )
    assert found is not None
    return found


def test_a_fold_is_searched_for_along_a_segment():
    problem = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1.0, [0.0], 1.0)
    engine = Engine(problem, (-2.0, 2.0), Settings.of(None))
    segment = Segment(engine, circle(-0.3, engine), circle(0.2, engine))
    root = locate(segment, Aim(SLOPE, NO_COLUMNS))
    assert root is not None and root.point.p == pytest.approx(1.0, abs=1e-13)
    assert abs(root.point.u[0]) < 1e-12 and root.error < 1e-12
    # by a function of the user's own it is the same place
    other = locate(segment, lambda point: float(point.tangent[-1]))
    assert other is not None and other.position == root.position and other.point.p == root.point.p
    assert locate(segment, aim_at_multiplier(0, "none", "plus", 1)) is None  # has no zero


def test_points_of_a_segment_are_solved_together_as_one_by_one():
    problem = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1.0, [0.0], 1.0)
    engine = Engine(problem, (-2.0, 2.0), Settings.of(None))
    segment = Segment(engine, circle(0.1, engine), circle(0.4, engine))
    places = (0.0, 0.3, 1.0)
    for s, point in zip(places, segment.several(places)):
        alone = segment.at(s)
        assert point is not None and alone is not None
        assert point.p == alone.p and np.array_equal(point.u, alone.u)
        assert point.u[0] ** 2 + point.p**2 == pytest.approx(1.0, abs=1e-14)
