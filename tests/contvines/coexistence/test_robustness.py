"""Robustness: closed-form basins of a map, kicks of the absorber that simulation confirms, intervals that end at special points."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import contvines as cv
from tests.machines import ABSORBER

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def well():
    # both states contract to 0 from |x| < 1/p, |y| < 2: x' = p x^2, y' = y^3 / 4
    problem = cv.MapProblem(lambda u, p: np.array([p * u[0] ** 2, 0.25 * u[1] ** 3]), [0.0, 0.0], 1.0)
    return cv.diagram(problem, within=(0.7, 1.5), depth=0)["B1"]


def test_the_smallest_kick_of_a_map_is_the_distance_to_its_boundary(well):
    for at in (1.1, 1.4):
        found = cv.robustness(well, at, starts=0)
        assert found.distance == pytest.approx(1.0 / at, rel=2e-3)
        assert found.reaches == "escaped"
    found = cv.robustness(well, 0.8, starts=0)  # the box of starts ends at 1, the basin at 1.25
    assert found.distance == np.inf
    assert found.to_dict()["distance"] is None
    assert "no kick within the box of starts" in str(found)


@pytest.fixture(scope="module")
def graph():
    machine = ABSORBER
    return cv.diagram(machine.orbit("LR", amplitude=0.55), over="amplitude", within=(0.17, 1.27), depth=1)


def test_a_kick_leads_elsewhere_and_a_smaller_one_does_not(graph):
    found = cv.robustness(graph["B1"], 0.3, starts=2000)
    machine = ABSORBER
    for part, word in ((0.98, "LR"), (1.02, found.reaches)):
        w, rate = found.place + part * found.kick
        reached = machine.attractor({"w": w, "w_rate": rate}, amplitude=0.3)
        assert reached.word.text == word
    assert found.distance == pytest.approx(np.linalg.norm(found.kick))
    low, high = found.share_interval
    counted = cv.basins(machine, "amplitude", 0.3, points=2).attractors  # another count: drawn uniformly
    assert counted
    population = machine.population("amplitude")
    drawn = np.random.default_rng(5).random((4000, 3))
    box = population.box(0.3)
    motions, index, _ = population.settle(box[:, 0] + drawn * np.ptp(box, axis=1), 0.3)
    share = np.mean([motions[k].word == "LR" for k in index])
    assert low - 0.02 < share < high + 0.02


def test_parameters_stay_in_their_stable_interval(graph):
    found = cv.robustness(graph["B1"], 0.5, starts=0, vary=("amplitude", "friction"))
    ends = found.parameters["amplitude"]
    assert ends[0] == pytest.approx(graph["LP1"].value, abs=1e-8)
    assert ends[1] == pytest.approx(graph["SB1"].value, abs=1e-8)
    low, high = found.parameters["friction"]
    assert low < 0.5 < high


def test_an_erosion_curve_falls_to_zero_at_the_fold(graph):
    found = cv.erosion(graph["B1"], [0.2530, 0.26, 0.3, 0.4], starts=64)
    assert np.all(np.diff(found.distances) > 0.0)
    assert found.distances[0] < 0.1
    axes = found.plot().axes[0]
    line = next(line for line in axes.lines if line.get_label() == "smallest kick that leads elsewhere")
    assert np.array_equal(line.get_xydata(), np.column_stack([found.values, found.distances]))
    assert "smallest kick" in str(found)


def test_on_the_command_line(tmp_path, graph):
    from contvines.command.cli import app

    graph.save(tmp_path / "a.vines")
    file, call = str(tmp_path / "a.vines"), CliRunner().invoke
    said = call(app, ["robustness", file, "B1", "--at", "0.3", "--starts", "50", "--vary", "restitution"])
    assert said.exit_code == 0
    assert "smallest kick that leads elsewhere" in said.stdout
    assert "stable and real for restitution" in said.stdout
    refused = str(call(app, ["robustness", file, "B1", "--at", "55"]).exception)
    assert "--at 55" in refused and "[0.17, 1.27]" in refused
    picture = tmp_path / "erosion.png"
    said = call(
        app, ["robustness", file, "B1", "--values", "2", "--starts", "20", "--json", "--plot", str(picture)]
    )
    assert said.exit_code == 0
    assert [entry["word"] for entry in json.loads(said.stdout)["values"]] == ["LR", "LR"]
    assert picture.stat().st_size > 5000
    said = call(app, ["robustness", file, "B9"])
    assert "B9 is no branch of it" in str(said.exception)
