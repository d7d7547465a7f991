"""Atlas and basins of plain maps, against closed forms and published numbers."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.loci.systems import henon_of

pytestmark = pytest.mark.slow


def staying(x, y):
    """The share of starts that the map with a = 1.4 does not drive away, counted with the formula alone."""
    with np.errstate(all="ignore"):
        for _ in range(300):
            x, y = 1 - 1.4 * x**2 + y, 0.3 * x
    return float(np.mean(np.isfinite(x) & (np.abs(x) < 10)))


@pytest.fixture(scope="module")
def population():
    return cv.MapProblem(henon_of, [0.6, 0.2], 1.4).population(box=[(-2, 2), (-2, 2)])


def test_the_basin_of_henons_attractor(population):
    """a = 1.4, b = 0.3: starts in [-2, 2]^2 escape or reach the attractor, whose exponent is 0.419 (per iterate)."""
    found = cv.basins(population, at=1.4, plane=("x0", "x1"), points=120)
    kinds = {a.kind: a for a in found.attractors}
    assert set(kinds) == {"chaotic", "escaped"}
    chaotic, share = kinds["chaotic"], staying(*np.meshgrid(found.x, found.y))
    assert chaotic.share == pytest.approx(share, abs=1e-12)
    assert chaotic.exponent == pytest.approx(0.419, abs=4 * chaotic.error + 0.003)
    low, high = found.interval(found.attractors.index(chaotic))
    assert low < share < high


def test_shares_of_henons_basin_are_within_three_sigma_of_counts_from_elsewhere(population):
    """Attractors.jl, test/mapping/attractor_mapping_tests.jl: 0.451 of 1000 starts, drawn uniformly from [-2, 2]^2, stay.

    A count of our own, 200,000 starts, tells it to three digits.
    """
    counted = staying(*np.random.default_rng(11).uniform(-2, 2, (2, 200_000)))
    motions, index, _ = population.settle(population.starts(8192, 0, 1.4), 1.4)
    share = np.mean(index == [m.kind for m in motions].index("chaotic"))
    for other, count in ((counted, 8192), (0.451, 1000)):
        assert abs(share - other) < 3 * np.sqrt(other * (1 - other) / count)


@pytest.mark.parametrize(("p", "expected"), [(0.5, [0.0]), (0.996, [0.0]), (1.3, [-(0.3**0.5), 0.3**0.5])])
def test_each_fixed_point_is_found_once(p, expected):
    """x -> p x - x^3: zero is reached geometrically, as p^n; it is no fixed point of the size at which floats end, nor several beside p = 1."""
    problem = cv.MapProblem(lambda x, p: [p * x[0] - x[0] ** 3], [0.1], 0.5)
    population = problem.population(box=[(-0.6, 0.7)])
    motions, index, _ = population.settle(population.starts(64, 0, p), p)
    found = sorted(float(motion.u[0]) for motion in motions)
    assert found == pytest.approx(expected, abs=1e-12) and set(index) == set(range(len(expected)))
