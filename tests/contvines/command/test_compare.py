"""Lines to compare a graph with, and numbers as people read them."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import contvines as cv
from contvines.command.compare import draw_compared
from contvines.command.compose import checked_study, first_orbit
from contvines.command.orbit import _number

STUDY = """
units = "si"
[model]
name = "coupled"
oscillator_mass = "3.8 kg"
natural_frequency = "8 Hz"
damping_ratio = 0.02
absorber_mass = "32 g"
half_width = "14 mm"
restitution = 0.6
friction = 0.5
base_amplitude = "1 mm"
[start]
word = ""
frequency = "3 Hz"
[continue]
parameter = "frequency"
within = ["2.9 Hz", "3.1 Hz"]
"""


@pytest.fixture(scope="module")
def graph(tmp_path_factory):
    path = tmp_path_factory.mktemp("compared") / "study.toml"
    path.write_text(STUDY)
    return cv.diagram(first_orbit(checked_study(path)), over="frequency", within=(2.9, 3.1), depth=0)


def test_the_bare_oscillator_of_a_shaken_base_in_millimetres(graph):
    """Shaken at its base by 1 mm: |1 + 2 i zeta r| / |1 - r^2 + 2 i zeta r| millimetres, r the frequency over 8 Hz."""
    figure, axes = plt.subplots()
    draw_compared(axes, graph, ["bare"], None, "max_abs_q1")
    values, response = axes.lines[0].get_data()
    plt.close(figure)
    r = np.asarray(values) / 8.0
    wanted = np.abs((1 + 0.04j * r) / (1 - r**2 + 0.04j * r))
    np.testing.assert_allclose(response, wanted, rtol=0.02)
    assert values[0] == 2.9 and values[-1] == 3.1


def test_lines_go_with_displacements_over_the_parameter_only(graph):
    _, axes = plt.subplots()
    for x, y in (("max_abs_q1", "max_abs_q1"), (None, "phase")):
        with pytest.raises(ValueError, match="this goes with the displacement of an oscillator"):
            draw_compared(axes, graph, ["bare"], x, y)
    plt.close("all")


@pytest.mark.parametrize(
    "value, shown", [(3e-7, "3e-07"), (-2.5e-14, "-2.5e-14"), (4e-16, "0"), (0.5, "0.5")]
)
def test_only_rounding_is_shown_as_zero(value, shown):
    assert _number(value) == shown
