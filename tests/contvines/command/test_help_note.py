"""The help of a command says what its -y is for the file on the line."""

import importlib
import inspect
from pathlib import Path

import pytest

from contvines.command.cli import COMMANDS

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.mark.parametrize(
    ("study", "measure"),
    [
        ("friction", "B"),
        ("frequency", "max_abs_q1"),
        ("bouncing_ball", "B"),
        ("machines/impact_oscillator", "approach_speed"),
    ],
)
def test_the_default_of_y_is_the_machines(run, study, measure):
    path = EXAMPLES / f"{study}.toml"
    status, out, _ = run("diagram", path, "--help")
    assert not status and out.endswith(f"For {path} the default of -y is {measure}.\n")


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_of_commands_says_what_the_help_of_each_begins_with(name):
    module, sentence = COMMANDS[name]
    said = inspect.getdoc(getattr(importlib.import_module(f"contvines.command.{module}"), name))
    assert " ".join(said.split("\n\n")[0].split()) == sentence
