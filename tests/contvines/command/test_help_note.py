"""The help of a command says what its -y is for the file on the line."""

from pathlib import Path

import pytest

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
