"""Which margin is the border of a segment."""

import numpy as np
import pytest

from contvines.bifurcation.detect import without_zeros
from contvines.bifurcation.first_border import find_border
from contvines.bifurcation.segment import Segment
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings
from tests.contvines.graph.test_borders import Line


def segment_of(margins, low, high):
    class Made(Line):
        def margins(self, u, p):
            return np.array(margins(p))

    engine = Engine(Made("a", 0.0, 1.0, [1.0] * len(margins(0.0)), [0.0]), (0.0, 1.0), Settings())
    return Segment(engine, engine.start(np.array([low]), low), engine.start(np.array([high]), high))


def test_a_margin_that_was_negative_before_does_not_fall():
    border = find_border(segment_of(lambda p: (-1e-6, 0.5 - p), 0.4, 0.6), True)
    assert border.index == 1 and border.root.point.p == pytest.approx(0.5, abs=1e-13)


def test_the_first_of_several_that_fall():
    border = find_border(segment_of(lambda p: (0.55 - p, 0.5 - p), 0.4, 0.6), True)
    assert border.index == 1 and border.root.point.p == pytest.approx(0.5, abs=1e-13)


def test_of_those_that_fall_together_the_kind_decides():
    border = find_border(segment_of(lambda p: (2 * (0.5 - p), 0.5 - p), 0.4, 0.6), True)
    assert border.index == 0  # a velocity graze comes before a wall graze


def test_a_virtual_branch_is_real_again_where_the_last_one_rises():
    border = find_border(segment_of(lambda p: (p - 0.45, p - 0.5), 0.4, 0.6), False)
    assert border.index == 1 and border.root.point.p == pytest.approx(0.5, abs=1e-13)
    assert find_border(segment_of(lambda p: (p - 0.45, p - 0.7), 0.4, 0.6), False) is None


def test_no_border():
    assert find_border(segment_of(lambda p: (1.0, 0.7 - p), 0.4, 0.6), True) is None


@pytest.mark.parametrize(
    "signs, filled",
    [
        ([1, 0, 1], [1, 1, 1]),
        ([-1, 0, 0, 1], [-1, -1, -1, 1]),
        ([0, -1, 1], [-1, -1, 1]),
        ([0, 0], [1, 1]),
    ],
)
def test_a_sign_of_zero_is_the_one_before_it(signs, filled):
    assert without_zeros(np.array(signs, float)).tolist() == filled
