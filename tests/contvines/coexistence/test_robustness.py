"""Robustness: closed-form basins of a map, kicks of the absorber that simulation confirms, intervals that end at special points."""

import json

import numpy as np
import pytest

import contvines as cv
from tests.machines import ABSORBER, absorber_graph

pytestmark = pytest.mark.slow


def test_the_smallest_kick_of_a_map_is_the_distance_to_its_boundary():
    """Both states contract to 0 from |x| < 1/p, |y| < 2: x' = p x^2, y' = y^3 / 4."""
    problem = cv.MapProblem(lambda u, p: [p * u[0] ** 2, 0.25 * u[1] ** 3], [0.0, 0.0], 1.0)
    well = cv.diagram(problem, within=(0.7, 1.5), depth=0)["B1"]
    for at in (1.1, 1.4):
        found = cv.robustness(well, at, starts=0)
        assert found.distance == pytest.approx(1.0 / at, rel=2e-3)
        assert found.reaches == "escaped"
    found = cv.robustness(well, 0.8, starts=0)  # the box of starts ends at 1, the basin at 1.25
    assert found.distance == np.inf and found.to_dict()["distance"] is None
    assert "no kick within the box of starts" in str(found)


@pytest.fixture(scope="module")
def graph():
    return absorber_graph(0.55, (0.17, 1.27), depth=1)


def test_a_kick_leads_elsewhere_and_a_smaller_one_does_not(graph):
    found = cv.robustness(graph["B1"], 0.3, starts=2000)
    for part, word in ((0.98, "LR"), (1.02, found.reaches)):
        w, rate = found.place + part * found.kick
        assert ABSORBER.attractor({"w": w, "w_rate": rate}, amplitude=0.3).word.text == word
    assert found.distance == pytest.approx(np.linalg.norm(found.kick))
    low, high = found.share_interval
    population = ABSORBER.population("amplitude")
    drawn = np.random.default_rng(5).random((4000, 3))  # another count: drawn uniformly
    box = population.box(0.3)
    motions, index, _ = population.settle(box[:, 0] + drawn * np.ptp(box, axis=1), 0.3)
    share = np.mean([motions[k].word == "LR" for k in index])
    assert low - 0.02 < share < high + 0.02


def test_parameters_stay_in_their_stable_interval(graph):
    found = cv.robustness(graph["B1"], 0.5, starts=0, vary=("amplitude", "friction")).parameters
    ends = [graph[label].value for label in ("LP1", "SB1")]
    assert found["amplitude"] == pytest.approx(ends, abs=1e-8)
    assert found["friction"][0] < 0.5 < found["friction"][1]


def test_an_erosion_curve_falls_to_zero_at_the_fold(graph):
    found = cv.erosion(graph["B1"], [0.2530, 0.26, 0.3, 0.4], starts=64)
    assert np.all(np.diff(found.distances) > 0.0)
    assert found.distances[0] < 0.1
    lines = {line.get_label(): line.get_xydata() for line in found.plot().axes[0].lines}
    drawn = lines["smallest kick that leads elsewhere"]
    assert np.array_equal(drawn, np.column_stack([found.values, found.distances]))
    assert "smallest kick" in str(found)


def test_on_the_command_line(tmp_path, graph, run):
    graph.save("a.vines")
    words = ("robustness", "a.vines")
    status, said, _ = run(*words, "B1", "--at", 0.3, "--starts", 50, "--vary", "restitution")
    assert status == 0 and "smallest kick that leads elsewhere" in said
    assert "stable and real for restitution" in said
    options = ("--values", 2, "--starts", 20, "--json", "--plot", "erosion.png")
    status, said, _ = run(*words, "B1", *options)
    assert status == 0
    assert [entry["word"] for entry in json.loads(said)["values"]] == ["LR", "LR"]
    assert (tmp_path / "erosion.png").stat().st_size > 5000
    refused = run(*words, "B1", "--at", 55)[2]
    assert "--at 55" in refused and "[0.17, 1.27]" in refused
    assert "B9 is no branch of it" in run(*words, "B9")[2]
