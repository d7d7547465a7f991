"""Stable manifolds: a parabola in closed form, Henon's saddle by iteration, the absorber's boundary by simulation."""

import json

import numpy as np
import pytest

import contvines as cv
from contvines.coexistence.manifolds import stable_manifolds
from tests.contvines.loci.systems import henon_of
from tests.contvines.studies import PAPER
from tests.machines import ABSORBER, absorber_graph

pytestmark = pytest.mark.slow


def halves_of(f, start, at, limits):
    graph = cv.diagram(cv.MapProblem(f, start, at), within=(at - 0.1, at + 0.1), depth=0)
    return stable_manifolds(graph, at, np.array([[-limit, limit] for limit in limits]))


@pytest.mark.parametrize("slow", [0.4, -0.4])  # a negative multiplier: the two halves change places
def test_a_parabola(slow):
    # x' = 2 x + 0.7 y^2, y' = slow y: x = K y^2 is invariant if K slow^2 = 2 K + 0.7
    bend = 0.7 / (slow * slow - 2.0)
    one, other = halves_of(
        lambda u, p: [p * u[0] + 0.7 * u[1] ** 2, slow * u[1]], [0.0, 0.0], 2.0, (3.0, 2.0)
    )
    for half in (one, other):
        assert half.ended == "leaves"
        assert np.abs(half.points[:, 0] - bend * half.points[:, 1] ** 2).max() < 1e-3
        assert abs(half.points[-1, 1]) > 2.0
    assert one.points[-1, 1] * other.points[-1, 1] < 0.0


def test_points_of_henons_manifold_fall_into_the_saddle():
    x = (-0.7 + np.sqrt(0.49 + 5.6)) / 2.8
    for half in halves_of(henon_of, [0.63, 0.19], 1.4, (2.0, 2.0)):
        for point in half.points[:: max(1, len(half.points) // 20)]:
            nearest = np.inf
            for _ in range(30):
                nearest = min(nearest, float(np.hypot(point[0] - x, point[1] - 0.3 * x)))
                point = henon_of(point, 1.4)
                if np.abs(point).max() > 10.0:
                    break
            assert nearest < 5e-3


@pytest.fixture(scope="module")
def graph():
    return absorber_graph(0.55, (0.17, 0.8), depth=1)


def test_the_two_sides_of_a_manifold_reach_different_motions(graph):
    found = cv.basins(ABSORBER, "amplitude", 0.3, points=20, saddles=graph)
    assert {curve.word for curve in found.manifolds} == {"LR"}
    population = ABSORBER.population("amplitude")
    for curve in found.manifolds:
        middle = 0.5 * (curve.points[1:] + curve.points[:-1])
        along = np.diff(curve.points, axis=0)
        across = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
        inside = np.all((np.abs(middle) < [0.95, 2.0]), axis=1)
        sides = []
        for side in (0.02, -0.02):
            states = (middle + side * across)[inside]
            motions, index, _ = population.settle(np.column_stack([np.zeros(len(states)), states]), 0.3)
            sides.append(np.array([motions[k].word for k in index]))
        assert np.all(sides[0] != sides[1])
    # every cell beside one of another colour lies beside a curve: they go on from wall to wall
    points = np.concatenate([curve.points for curve in found.manifolds])
    cell = np.array([found.x[1] - found.x[0], found.y[1] - found.y[0]])
    middles = [
        (found.x[j] + 0.5 * cell[0] * right, found.y[i] + 0.5 * cell[1] * (1 - right))
        for right in (0, 1)
        for i, j in np.argwhere(np.diff(found.index, axis=right) != 0)
    ]
    assert len(middles) > 40
    for middle in middles:
        assert np.abs((points - middle) / cell).max(axis=1).min() < 1.0
    assert {curve.ended for curve in found.manifolds} == {"wall", "leaves"}
    assert json.loads(json.dumps(found.to_dict()))["manifolds"][0]["word"] == "LR"
    lines = found.plot().axes[0].lines
    assert len(lines) == len(found.manifolds)
    assert np.array_equal(lines[0].get_xydata(), found.manifolds[0].points)


def test_on_the_command_line(tmp_path, graph, run):
    graph.save("a.vines")
    (tmp_path / "a.toml").write_text(PAPER)
    status, said, _ = run("basins", "a.toml", "--at", 0.3, "--points", 10, "--saddles", "a.vines")
    assert status == 0 and "stable manifold of LR on B1" in said
