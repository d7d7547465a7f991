"""Kill -9 and Ctrl-C in the middle of `contvines chart`, then the same command again: the same chart; bad input answered in sentences."""

import pytest
from typer.testing import CliRunner

from contvines.command.cli import app

STUDY = """
[model]
name = "absorber"
restitution = 0.76
friction = 0.5
gravity = 0.211
mass_ratio = 0.006
[start]
word = "LR"
periods = 1
amplitude = 0.55
[continue]
parameter = "amplitude"
within = [0.2, 0.95]
depth = 0
"""


@pytest.fixture(scope="module")
def diagram(tmp_path_factory):
    folder = tmp_path_factory.mktemp("chart")
    (folder / "study.toml").write_text(STUDY)
    path = folder / "study.vines"
    result = CliRunner().invoke(
        app, ["diagram", str(folder / "study.toml"), "-q", "--no-look", "-o", str(path)]
    )
    assert result.exit_code == 0, result.output
    return path


@pytest.mark.parametrize(
    "changed, said",
    [
        ({"--over": "viscosity"}, "over = 'viscosity': the problem has no such parameter; it has amplitude"),
        ({"--over": "amplitude"}, "over = 'amplitude' is the parameter of the diagram itself"),
        ({"--within": ("0.6", "0.9")}, "was made at friction = 0.5, outside of within"),
        ({"--within": ("0.9", "0.2")}, "give the lower value first"),
        ({"--within": ("-1", "0.9")}, "friction = -1 is out of range"),
    ],
)
@pytest.mark.parametrize("verb", ["chart", "locus"])
def test_bad_input_is_answered_in_a_sentence(diagram, tmp_path, verb, changed, said):
    given = {"--over": "friction", "--within": ("0.4", "0.6"), **changed}
    line = [verb, str(diagram)] + (["LP1"] if verb == "locus" else [])
    line += ["--over", given["--over"], "--within", *given["--within"], "-o", str(tmp_path / "x.vines")]
    result = CliRunner().invoke(app, line)
    assert result.exit_code != 0
    assert said in str(result.exception)
    assert isinstance(result.exception, ValueError | KeyError)


def test_labels_without_a_locus_are_refused(diagram, tmp_path):
    for label, said in (
        ("EP1", "EP1 is no special point of the motion"),
        ("B1", "B1 is a branch"),
        ("XY7", "XY7 is no label of it; its special points are"),
    ):
        line = [
            "locus",
            str(diagram),
            label,
            "--over",
            "friction",
            "--within",
            "0.4",
            "0.6",
            "-o",
            str(tmp_path / "x.vines"),
        ]
        result = CliRunner().invoke(app, line)
        assert result.exit_code != 0 and said in str(result.exception), str(result.exception)
