"""`contvines design`: the table, the JSON, the picture and its refusals."""

from __future__ import annotations

import json

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from contvines.command.design import design, machine
from contvines.command.study import StudyError, check_study
from tests.contvines.studies import PAPER_MACHINE

STUDY = (
    PAPER_MACHINE
    + """
[start]
word = "LR"
periods = 1
amplitude = 0.55

[continue]
parameter = "amplitude"
within = [0.2, 1.3]
"""
)


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def run(*arguments):
    app = typer.Typer(rich_markup_mode=None)  # as the command line has it
    app.command()(design)
    return CliRunner().invoke(app, [str(a) for a in arguments])


def test_table_has_units(study):
    result = run(study, "--no-plot")
    assert result.exit_code == 0, result.output
    assert "activation threshold" in result.output and "..." not in result.output.replace("…", "...")
    assert "ratio, large amplitude" in result.output and "operating ratio" in result.output
    assert "q1_min" in result.output and "mm" in result.output and "xi" in result.output


def test_json_in_si_units(study):
    found = json.loads(run(study, "--no-plot", "--json").output)
    # by hand: R = 3/22, h = (pi/2)(1.006)(0.1055); C_min = (pi h + 2 R)/sqrt(pi^2 + 4 R^2); b = 20 mm
    R, h = 3 / 22, np.pi / 2 * 1.006 * 0.1055
    threshold = 0.02 * (np.pi * h + 2 * R) / np.sqrt(np.pi**2 + 4 * R**2)
    assert found["q1_min"]["value"] == pytest.approx(threshold, rel=1e-12)
    assert found["q1_min"]["unit"] == "m"
    assert found["xi"]["value"] == pytest.approx(np.sqrt(0.5282903 / 0.0637942), rel=1e-6)


def test_an_assumed_scale_is_named(study):
    """Lengths are proportional to the half-width; a study with its own scale and damping assumes gravity alone."""
    free = json.loads(run(study, "--no-plot", "--json").output)
    own = json.loads(run(study, "--no-plot", "--json", "--half-width", "0.03").output)
    assert free["q1_max"]["value"] / own["q1_max"]["value"] == pytest.approx(2.0 / 3.0, rel=1e-12)
    assert set(free["assumed"]) == {"half_width", "acceleration", "damping"}
    assert set(own["assumed"]) == {"acceleration", "damping"}
    assert "20 mm" in free["assumed"]["half_width"] and "--half-width" in free["assumed"]["half_width"]
    table = run(study, "--no-plot").output
    assert "assumed: the half-width of the cavity is 20 mm" in " ".join(table.split())
    assert "half-width of the cavity" not in run(study, "--no-plot", "--natural-frequency", "8").output


def test_picture(study, tmp_path):
    target = tmp_path / "map.png"
    assert run(study, "--plot", target).exit_code == 0
    assert target.stat().st_size > 20_000


def test_a_small_picture_has_the_bounds_alone(study, tmp_path):
    from contvines.command.design import draw
    from contvines.command.study import read_study

    figures = machine(read_study(study), None, None)
    assert len(draw(figures).axes) == 6
    small = draw(figures, (3.4, 2.4))
    (axes,) = small.axes
    small.canvas.draw()
    curves = {line.get_label(): line.get_ydata() for line in axes.lines}
    low, high = (next(v for k, v in curves.items() if k.startswith(name)) for name in ("activation", "upper"))
    assert (low < high).all()
    assert axes.yaxis.label.get_window_extent().x0 >= 0 and axes.xaxis.label.get_window_extent().y0 >= 0
    refused = run(study, "--size", "0.1", "2")
    assert refused.exit_code and "give inches between 1 and 60" in str(refused.exception)


def test_scale_is_given_once(tmp_path):
    import tomllib

    data = check_study(tomllib.loads(STUDY))
    assert machine(data, None, 7.666).cavity == pytest.approx(0.02004, rel=1e-3)
    with pytest.raises(StudyError, match="give one of them"):
        machine(data, 0.02, 7.666)
    with pytest.raises(StudyError, match="--cavity"):
        machine(data, -1.0, None)
    floating = check_study(tomllib.loads(STUDY.replace("gravity = 0.211", "gravity = 0")))
    with pytest.raises(StudyError, match="give both"):
        machine(floating, None, None)


def test_help_shows_the_units(monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    out = run("--help").output
    assert "cavity [m];" in out and "oscillator [Hz]," in out


@pytest.mark.parametrize(
    ("cavity", "frequency", "gravity", "sentence"),
    [
        (1e300, None, 0.211, r"--cavity = 1e\+300 is out of range; .* m would do, for example 0.02"),
        (0.0, None, 0.211, r"--cavity = 0.0 is out of range"),
        (
            None,
            1e300,
            0.211,
            r"--natural-frequency = 1e\+300 is out of range; .* Hz would do, for example 7.666",
        ),
        (None, float("nan"), 0.211, "--natural-frequency = nan is out of range"),
        (
            None,
            1e9,
            0.211,
            r"\[model\] gravity = 0.211 with natural_frequency = .* Hz means cavity = .*; change one",
        ),
        (0.02, None, 1e-300, r"\[model\] gravity = 1e-300 with cavity = 0.02 m means natural_frequency = "),
        (None, None, 1e-300, r"\[model\] gravity = 1e-300 with cavity = 0.02 m means natural_frequency = "),
        (1e300, 7.0, 0.0, "--cavity = "),
    ],
)
def test_scales_out_of_range_are_refused(cavity, frequency, gravity, sentence):
    import tomllib

    study = check_study(tomllib.loads(STUDY.replace("gravity = 0.211", f"gravity = {gravity!r}")))
    with pytest.raises(StudyError, match=sentence):
        machine(study, cavity, frequency)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("old", "new", "more"),
    [
        (
            "restitution = 0.76",
            "restitution = 1",
            (),
        ),  # without friction the threshold is zero, the ratio infinite
        ("friction = 0.5", "friction = 0", ()),
        (
            "gravity = 0.211",
            "gravity = 0",
            ("--cavity", 0.02, "--natural-frequency", 7),
        ),  # a ratio that never changes
        ("friction = 0.5", "friction = 1e6", ("--cavity", 1e9)),
    ],
)
def test_extreme_machines_have_a_table_and_a_picture(study, tmp_path, old, new, more):
    study.write_text(STUDY.replace(old, new))
    target = tmp_path / "map.png"
    result = run(study, "--plot", target, *more)
    assert result.exit_code == 0, result.output
    assert target.stat().st_size > 20_000


def test_an_infinite_ratio_is_null_in_json(study):
    study.write_text(
        STUDY.replace("restitution = 0.76", "restitution = 1").replace("friction = 0.5", "friction = 0")
    )
    text = run(study, "--no-plot", "--json").output
    assert "Infinity" not in text
    found = json.loads(text)
    assert found["q1_min"]["value"] == 0.0
    assert found["xi"]["value"] is None
