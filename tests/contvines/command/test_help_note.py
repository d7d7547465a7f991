"""The help of a command says what its -y is for the file on the line."""

from pathlib import Path

import pytest

from contvines.command.cli import main
from contvines.command.help_note import help_note

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
def test_the_default_of_y_is_the_machines(study, measure, capsys):
    path = EXAMPLES / f"{study}.toml"
    with pytest.raises(SystemExit) as end:
        main(["diagram", str(path), "--help"])
    assert not end.value.code
    assert capsys.readouterr().out.endswith(f"For {path} the default of -y is {measure}.\n")


def test_it_is_what_a_picture_then_shows(tmp_path):
    import contvines as cv
    from contvines.plots.style import axis_label

    circle = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1, [1.0], 0.0)
    graph = cv.diagram(circle, within=(-2.0, 2.0), depth=0)
    graph.save(tmp_path / "circle.vines")
    name = help_note(["plot", str(tmp_path / "circle.vines"), "--help"]).split()[-1].rstrip(".")
    assert cv.load(tmp_path / "circle.vines").plot().axes[0].get_ylabel() == axis_label(name)


@pytest.mark.parametrize(
    "words", [["diagram", "--help"], ["show", "a.vines", "-h"], ["diagram", "none.toml", "-h"]]
)
def test_nothing_is_added_without_a_file(words):
    assert help_note(words) == ""


def test_a_study_that_will_not_do_still_has_its_help(tmp_path):
    (tmp_path / "a.toml").write_text("[model]\nname = 'nothing'\n")
    assert help_note(["diagram", str(tmp_path / "a.toml"), "--help"]) == ""
