"""Multipliers at the border of a branch that begins beside it, where those computed at the border itself are rounding."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.lines import Word, ending, seed


def begun_beside(multiplier, distance, step, end=1.0):
    """The multiplier with which word "b" begins at p = 1/2: it is traced from a point at some distance; what is computed at the border itself is something else."""

    def beyond(line, point):
        other = Word(
            "b", -0.5, 2.0, [1.0, -1.0], [0.5, end],
            multipliers=lambda u, p: [multiplier(p - 0.5) if abs(p - 0.5) >= 1e-11 else 7.0],
        )  # fmt: skip
        return seed(other, 0.5 + 2.0 * distance, 0.5 + distance)

    steps = {"first_step": step, "max_step": max(step, 0.03)}
    branch = cv.diagram(ending(beyond), within=(0.0, 1.0), settings=steps)["B2"]
    assert branch.values[0] == pytest.approx(0.5, abs=1e-12)
    return branch.multipliers[0, 0]


@pytest.mark.parametrize("step", [3e-7, 1e-3])
@pytest.mark.parametrize("distance", [1e-8, 2e-7, 3e-6, 1e-4, 1e-2])
def test_the_limit_does_not_depend_on_where_the_branch_is_entered(distance, step):
    """sin(3 t)/t tends to 3."""
    for end in (1.0, 0.5 + 1.5 * distance):
        seen = begun_beside(lambda t: np.sin(3.0 * t) / t, distance, step, end)
        assert seen == pytest.approx(3.0, rel=1e-6)


@pytest.mark.parametrize("step", [3e-7, 1e-3])
@pytest.mark.parametrize("distance", [1e-8, 2e-7, 1e-4])
@pytest.mark.parametrize("noise", [0.0, 1e-10])
def test_without_bound_beside_the_border_is_without_bound_at_it(distance, noise, step):
    """-2e-5/t, its t known up to a little: only that it grows like that can be determined, and is enough."""
    seen = begun_beside(lambda t: -2e-5 / (t + noise * np.sin(1e9 * t)), distance, step)
    assert seen.real <= -1e12
