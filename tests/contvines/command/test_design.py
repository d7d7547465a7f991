"""`contvines design`: the table, the JSON, the picture and its refusals."""

from __future__ import annotations

import json

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from contvines.command.design import design
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


def test_an_inclined_cavity_is_refused(study, tmp_path):
    (tmp_path / "inclined.toml").write_text(
        '[model]\nname = "coupled"\nrestitution = 0.7\nfriction = 0.1\ngravity = 0.2\nmass_ratio = 0.01\nslope = 0.1\n[start]\nforcing = 3.0\n'
        '[continue]\nparameter = "frequency"\nwithin = [0.9, 1.1]\n'
    )
    result = run(tmp_path / "inclined.toml")
    assert isinstance(result.exception, ValueError) and "closed forms of level cavities" in str(
        result.exception
    )


def test_picture(study, tmp_path):
    target = tmp_path / "map.png"
    assert run(study, "--plot", target).exit_code == 0
    assert target.stat().st_size > 20_000
