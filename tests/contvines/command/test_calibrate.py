"""`contvines calibrate`: restitution from impact times and from a sweep that another simulator made, with noise; refusals."""

import json

import numpy as np
import pytest
from matplotlib.image import imread

from contvines.command.calibrate import calibration_text
from orbits.design.calibration import Calibration
from tests.orbits.design.laboratory import STUDY, measurement

pytestmark = pytest.mark.slow


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "panel.toml"
    path.write_text(STUDY)
    return path


def test_restitution_and_friction_of_a_free_decay(run, study, tmp_path):
    hits = measurement(0.66, 0.11, 12e-3, lambda t: 0.0, 1.0, most=24)[0]
    noisy = 1e3 * (hits + 0.35) + np.random.default_rng(3).normal(0.0, 0.05, hits.size)
    (tmp_path / "hits.csv").write_text("time [ms]\n" + "\n".join(f"{t:.5f}" for t in noisy))
    words = ["calibrate", study, "--impacts", tmp_path / "hits.csv", "--release", "12 mm"]
    words += ["--unknown", "restitution", "--unknown", "friction"]
    done = run(*words, "--json", "--plot", tmp_path / "c.png", "--size", 3.4, 2.4)
    found = json.loads(done[1])
    for name, true in (("restitution", 0.66), ("friction", 0.11)):
        low, high = found["intervals"][name]
        assert low < true < high
    low, high = found["intervals"]["restitution"]
    assert high - low < 0.02 and 3e-5 < found["scatter"] < 8e-5  # s: the noise is 5e-5
    assert imread(tmp_path / "c.png").shape[:2] == (480, 680)  # at 200 dots an inch


@pytest.mark.parametrize(
    ("data", "options", "says"),
    [
        ("0\n1\nx\n", [], "row 3 holds 'x', not 1 number"),
        ("time [kg]\n0\n1\n2\n", [], "which is no unit of this time; expected s"),
        ("0\n2\n1\n", [], "the instants do not grow at number 3: sort them"),
        ("0\n1\n", [], "too few impacts"),
        ("", [], "there is no row of numbers; give 1 column"),
        ("0\n1\n2\n", ["--unknown", "restitusion"], "no such parameter (did you mean 'restitution'?)"),
        ("0\n1\n2\n", ["--limits", "restitution=0.9,0.3"], "expected low < high"),
        ("0\n1\n2\n", ["--limits", "friction=0,1"], "friction is not estimated"),
        ("0\n1\n2\n", ["--confidence", "95"], "give a number between 0 and 1"),
        ("0\n1\n2\n", ["--release", "12"], "has no unit"),
        ("0\n1\n2\n", ["--release", "12 kg"], "--release is shown in mm"),
        ("0\n1\n2\n", ["--measure", "max_abs_q1"], "this goes with --sweep"),
        ("0\n0.1\n7\n7.1\n15\n", ["--release", "12 mm"], "the model follow these impacts"),
    ],
)
def test_bad_data_and_options_get_a_sentence(run, study, tmp_path, data, options, says):
    (tmp_path / "hits.csv").write_text(data)
    done = run("calibrate", study, "--impacts", tmp_path / "hits.csv", *options)
    assert done[0] and says in done[2], done[2]


def test_one_measurement_is_needed(run, study, tmp_path):
    assert "neither is given" in run("calibrate", study)[2]
    assert "cannot be read" in run("calibrate", study, "--impacts", tmp_path / "no.csv")[2]


def test_a_scatter_that_no_clock_has_is_doubtful():
    """Hand-made estimates of impacts 4 s apart: 1 % of that is 40 ms."""
    for scatter, doubtful in ((0.03, False), (0.09, True)):
        interval = {"restitution": (0.6, 0.8)}
        found = Calibration(
            {"restitution": 0.7}, interval, 0.95, scatter, np.zeros(12), np.eye(1), between=4.0
        )
        assert (
            "doubtful: the scatter is 2.2 % of" in calibration_text(found, {}, {"restitution": 0.6})
        ) == doubtful
