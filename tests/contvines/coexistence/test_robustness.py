"""Robustness: closed-form basins of a map, kicks of the absorber that simulation confirms, intervals that end at special points."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import contvines as cv
from orbits import Absorber
from orbits.machines.physical import physical
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


def test_units_change_what_is_near(well):
    found = cv.robustness(well, 1.4, starts=0, units={"x1": 10.0})
    assert found.distance == pytest.approx(1.0 / 1.4, rel=2e-3)
    found = cv.robustness(well, 1.4, starts=0, units={"x0": 0.1, "x1": 1.0})
    assert found.distance == pytest.approx(10.0 / 1.4, rel=2e-2)


@pytest.fixture(scope="module")
def graph():
    machine = ABSORBER
    return cv.diagram(machine.orbit("LR", amplitude=0.55), over="amplitude", within=(0.17, 1.27), depth=1)


def test_another_unit_of_time_gives_the_same_kick(graph):
    # with time counted in 1/1.4 and gravity 1.4^2 times as large the equations are the same; velocities are 1.4 times as large
    other = Absorber(restitution=0.76, friction=0.5, gravity=0.211 * 1.96, mass_ratio=0.006, frequency=1.4)
    same = cv.diagram(other.orbit("LR", amplitude=0.3), over="amplitude", within=(0.28, 0.32), depth=0)
    one = cv.robustness(graph["B1"], 0.3, starts=0)
    two = cv.robustness(same["B1"], 0.3, starts=0, units={"w_rate": 1.4})
    assert two.place == pytest.approx(one.place * [1.0, 1.4], abs=1e-8)
    assert two.distance == pytest.approx(one.distance, rel=1e-6)
    assert two.kick == pytest.approx(one.kick * [1.0, 1.4], rel=1e-5)


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


def test_a_kick_of_a_machine_in_kilograms_leads_to_the_sliding_motion():
    """Four states, and quantities with units; `attractor` simulates what is short of the kick, and the kick."""
    machine = physical(
        "coupled",
        {
            "oscillator_mass": "3.8 kg",
            "natural_frequency": "8 Hz",
            "absorber_mass": "32 g",
            "half_width": "30 mm",
            "damping_ratio": 0.007,
            "restitution": 0.6,
            "friction": 0.1,
            "base_amplitude": "0.3 mm",
        },
    )
    graph = cv.diagram(machine.orbit("LR", frequency="7.9 Hz"), over="frequency", within=(7.8, 8.1), depth=0)
    found = cv.robustness(graph["B1"], 8.0, starts=64, directions=16)
    assert found.names == ("w", "w_rate", "v", "v_rate") and found.reaches == "tt"
    assert 0.8 < found.share <= 1.0
    for part, impacts in ((0.98, 2), (1.0, 0)):  # the boundary is folded: further out may be inside again
        start = dict(zip(found.names, found.place + part * found.kick, strict=True))
        assert machine.attractor(start, frequency="8 Hz").impacts == impacts
    # told in millimetres and millimetres a second: 30 mm and 30 mm 2 pi 8 Hz are one
    told, speed = found.to_dict(), 30.0 * 2.0 * np.pi * 8.0
    assert told["kick"] == pytest.approx(found.kick * [30.0, speed, 30.0, speed], rel=1e-12)
    assert told["units"] == {"frequency": "Hz", "w": "mm", "w_rate": "mm/s", "v": "mm", "v_rate": "mm/s"}
    assert "frequency = 8 Hz" in str(found) and f"w {told['kick'][0]:+.4g} mm, w_rate" in " ".join(
        str(found).split()
    )
    assert (
        str(cv.erosion(graph["B1"], [8.0], starts=64, directions=16))
        .splitlines()[2]
        .startswith("frequency [Hz]")
    )
