"""Virtual branches begin at their border with the multipliers of the orbits beside it, and with one point."""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber
from orbits.attractors import find_attractor
from orbits.starts.find import polish
from tools.fuzz.between import Between


@pytest.fixture(scope="module")
def graph():
    """A stick vanishes, and beyond it the equations are singular at the border itself."""
    machine = Absorber(
        restitution=0.23453657194897234,
        friction=0.969671698765364,
        gravity=0.6684269613010174,
        mass_ratio=0.006,
        frequency=1.0104914583601698,
    )
    found = find_attractor(machine, amplitude=2.501431451118708)
    assert found.word.text == "LtLtsRtRts"
    within = (2.101431451118708, 2.901431451118708)
    return cv.diagram(polish(found.orbit), over="amplitude", within=within, depth=1, virtual=True)


def test_multipliers_at_the_border_are_those_beside_it(graph):
    beyond = [b for b in graph if not b.real and b.multipliers.shape[1]]
    assert len(beyond) >= 3
    for branch in beyond:
        (_, orbit), (_, nearer) = Between(branch, graph.within).beside(0, 1, (1e-3, 1e-5))
        listed = np.poly(branch.multipliers[0])
        gaps = [np.abs(np.poly(seen.multipliers) - listed).max() for seen in (orbit, nearer)]
        if np.abs(listed).max() < 1e8:
            assert gaps[1] < max(1e-6 * np.abs(listed).max(), 0.5 * gaps[0]), branch.label
        else:  # without bound
            assert np.abs(nearer.multipliers).max() > 10.0 * np.abs(orbit.multipliers).max()


def test_the_border_is_one_point(graph):
    for branch in graph:
        steps = np.abs(np.diff(branch.points, axis=0)).max(axis=1) + np.abs(np.diff(branch.values))
        assert steps.min() > 1e-9, branch.label
        assert np.isfinite(branch.multipliers).all()
