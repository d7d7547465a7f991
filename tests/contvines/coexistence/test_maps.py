"""Atlas and basins of plain maps, against closed forms and published numbers."""

import numpy as np
import pytest

import contvines as cv

pytestmark = pytest.mark.slow


def henon(x, p):
    return np.array([1 - p * x[0] ** 2 + x[1], 0.3 * x[0]])


def test_the_basin_of_henons_attractor():
    """a = 1.4, b = 0.3: starts in [-2, 2]^2 escape or reach the attractor, whose exponent is 0.419 (per iterate).

    The share is counted here by iterating the formula alone, 300 times, on the same starts.
    """
    problem = cv.MapProblem(henon, [0.6, 0.2], 1.4, parameter="a")
    population = problem.population(box=[(-2, 2), (-2, 2)])
    found = cv.basins(population, at=1.4, plane=("x0", "x1"), points=120)
    kinds = {a.kind: a for a in found.attractors}
    assert set(kinds) == {"chaotic", "escaped"}
    x, y = np.meshgrid(found.x, found.y)
    with np.errstate(all="ignore"):
        for _ in range(300):
            x, y = 1 - 1.4 * x**2 + y, 0.3 * x
    stays = np.isfinite(x) & (np.abs(x) < 10)
    share = float(stays.mean())
    assert kinds["chaotic"].share == pytest.approx(share, abs=1e-12)
    assert kinds["chaotic"].exponent == pytest.approx(0.419, abs=4 * kinds["chaotic"].error + 0.003)
    low, high = found.interval([a.kind for a in found.attractors].index("chaotic"))
    assert low < share < high


def test_coexisting_cycles_are_roots_of_their_own():
    """x -> x + sin(2 pi x)/8 on the line: every half-integer attracts, every integer repels: separate for ever."""
    problem = cv.MapProblem(lambda x, p: x + p * np.sin(2 * np.pi * x) / 8, [0.5], 1.0)
    population = problem.population(box=[(0.0, 3.0)])
    graph = cv.atlas(population, within=(0.5, 1.5), values=3, starts=64, depth=0)
    places = sorted({round(float(b.points[0, 0]), 9) for b in graph})
    assert places == [0.5, 1.5, 2.5]
    for value in {a.value for a in graph.attractors}:
        here = [a for a in graph.attractors if a.value == value]
        assert sum(a.share for a in here) == pytest.approx(1.0)
        assert sorted(a.branch for a in here) == sorted(graph.branches)
        for a in here:
            assert a.share == pytest.approx(1 / 3, abs=0.05 if a.starts == 64 else 0.1)  # by symmetry


def test_shares_of_henons_basin_are_within_three_sigma_of_counts_from_elsewhere():
    """Attractors.jl, test/mapping/attractor_mapping_tests.jl: 0.451 of 1000 starts, drawn uniformly from [-2, 2]^2, stay.

    A count of our own with the formula alone, 200,000 starts, tells it to three digits.
    """
    draw = np.random.default_rng(11)
    x, y = draw.uniform(-2, 2, (2, 200_000))
    with np.errstate(all="ignore"):
        for _ in range(200):
            x, y = 1 - 1.4 * x**2 + y, 0.3 * x
    counted = np.mean(np.isfinite(x) & (np.abs(x) < 10))
    population = cv.MapProblem(henon, [0.6, 0.2], 1.4, parameter="a").population(box=[(-2, 2), (-2, 2)])
    motions, index, _ = population.settle(population.starts(8192, 0, 1.4), 1.4)
    share = np.mean(index == [m.kind for m in motions].index("chaotic"))
    assert abs(share - counted) < 3 * np.sqrt(counted * (1 - counted) / 8192)
    assert abs(share - 0.451) < 3 * np.sqrt(0.451 * 0.549 / 1000)
