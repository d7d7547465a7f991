"""The symmetric LR orbit written many times: nothing is missed, nothing drifts, at any tolerance.

Expected values are the closed forms of the symmetric orbit (fold and symmetry breaking at Omega = 1):
C^2 = (1 - pi beta/2)^2 + (R beta + H)^2 with beta = (2 pi - 4 R H)/(pi^2 +- 4 R^2 or - 4).
"""

import numpy as np
import pytest

import contvines as cv
from tests.machines import ABSORBER

pytestmark = pytest.mark.slow

R = (1 - 0.76) / (1 + 0.76)
H = 0.5 * np.pi * (1 + 0.006) * 0.5 * 0.211


def squared(beta):
    return (1 - 0.5 * np.pi * beta) ** 2 + (R * beta + H) ** 2


FOLD = squared((2 * np.pi - 4 * R * H) / (np.pi**2 + 4 * R**2))
BREAKING = squared((2 * np.pi - 4 * R * H) / (np.pi**2 - 4))


def repeated(times):
    seed = ABSORBER.symmetric_orbit(amplitude=0.55)
    half = seed.problem("amplitude")
    u, p = seed.seed(half)
    nodes = np.asarray(half.expand(u)).reshape(1, 2, 2)
    shift = 2 * np.pi * np.arange(times)[:, None, None] * np.array([1.0, 0.0])
    word = half.word
    for _ in range(int(np.log2(times))):
        word = word.double()
    problem = half.sibling(word, times, False)
    problem.u0, problem.p0 = (nodes + shift).reshape(-1), p
    return problem


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("times", [1, 4, 16, 64, 256])
def test_fold_and_symmetry_breaking_of_the_repeated_orbit(times, tolerance):
    problem = repeated(times)
    graph = cv.diagram(problem, within=(0.2, 0.9), depth=0, settings={"tolerance": tolerance}, virtual=True)
    fold = [point.value**2 for point in graph.of_kind("fold")]
    assert fold == pytest.approx([FOLD], abs=1e-12)
    breaking = graph.of_kind("symmetry-breaking") + graph.of_kind("branch-point")
    assert [point.value**2 for point in breaking] == pytest.approx([BREAKING], abs=1e-10)
    branch = graph["B1"]
    problem = branch.problem  # what repeats a shorter orbit is followed as that one
    assert len(problem.word) == 2
    residuals = [
        problem.kernels.linearise(problem.data, branch.points[i], branch.values[i], problem.workspace())
        for i in range(0, len(branch), 10)
    ]
    assert max(residuals) < 1e-14 * 40 * times
    # every point is the symmetric orbit: the second impact is the mirror image of the first, half a period later
    nodes = problem.expand(branch.points).reshape(len(branch), 1, 2, 2)
    np.testing.assert_allclose(nodes[:, :, 1, 0] - nodes[:, :, 0, 0], np.pi, atol=1e-9)
    np.testing.assert_allclose(nodes[:, :, 1, 1], -nodes[:, :, 0, 1], atol=1e-9)
