"""What a sweep's picture shows: which dots, over which lines, under which names."""

import numpy as np
import pytest

from contvines.command.compose import first_orbit, run_diagram
from contvines.command.study import read_study
from contvines.command.sweep import _simulate
from contvines.command.sweep_picture import picture
from tests.contvines.studies import PAPER_MACHINE

REDUCED = (
    PAPER_MACHINE
    + """[start]
word = "LR"
amplitude = 0.55
[continue]
parameter = "amplitude"
within = [0.2, 0.95]
depth = 2
[sweep]
within = {within}
count = 12
"""
)
MODULATED = """
[model]
name = "coupled"
restitution = 0.7
friction = 0.3
gravity = 0.25
mass_ratio = 0.01
damping = 0.8
frequency = 1.0
[start]
word = "tt"
forcing = 0.86
[continue]
parameter = "forcing"
within = [0.8, 1.1]
[sweep]
within = [0.86, 1.04]
count = 7
"""


def drawn(tmp_path, text, over=False):
    """Dots by legend entry, and the figure's legend, of a study's sweep."""
    (tmp_path / "a.toml").write_text(text)
    study = read_study(tmp_path / "a.toml")
    graph = run_diagram(study, first_orbit(study)) if over else None
    rows = _simulate(study, False, tmp_path / "a.csv", True)
    axes = picture(rows, study, graph).axes[0]
    dots = {
        line.get_label(): np.column_stack(line.get_data())
        for line in axes.lines
        if str(line.get_label()).startswith("simulated")
    }
    legend = [entry.get_text() for entry in axes.get_legend().get_texts()]
    return dots, legend, rows, graph


@pytest.mark.parametrize("over", [False, True])
def test_motions_that_do_not_recur_have_dots_of_their_own(tmp_path, over):
    """Between the sliding motion's wall graze at 0.9004 and the Neimark-Sacker point at 0.972 nothing periodic is stable."""
    dots, legend, _, _ = drawn(tmp_path, MODULATED, over)
    assert set(dots) == {"simulated: periodic", "simulated: not periodic"} <= set(legend)
    assert {0.92, 0.95} <= set(np.round(dots["simulated: not periodic"][:, 0], 6))
    assert {0.86, 0.89, 1.04} <= set(np.round(dots["simulated: periodic"][:, 0], 6))
    assert dots["simulated: not periodic"][:, 1] == pytest.approx(1.0, abs=0.05)
    assert len(dots["simulated: periodic"]) + len(dots["simulated: not periodic"]) == 7


def test_dark_dots_lie_on_the_lines_and_light_ones_are_the_other_impacts(tmp_path):
    dots, legend, rows, graph = drawn(tmp_path, REDUCED.format(within=[0.5, 0.85]), over=True)
    first, others = dots["simulated: B at the first impact"], dots["simulated: B at other impacts"]
    assert set(dots) <= set(legend)
    assert first[:, 0] == pytest.approx(np.linspace(0.5, 0.85, 12)) and len(others) == 12
    lines = [(b.values, b.measure("B")) for b in graph.branches.values() if b.description["word"] == "LR"]
    for value, height in first:
        near = [
            abs(np.interp(value, v[order], h[order]) - height)
            for v, h in lines
            for order in [np.argsort(v)]
            if v.min() <= value <= v.max() and np.all(np.diff(v[order]) > 0)
        ]
        if value > 0.74:  # beyond the symmetry breaking at C^2 = 0.52829
            assert min(near) < 1e-3
    apart = others[:, 0] > 0.74
    assert np.all(np.abs(first[apart, 1] - others[apart, 1]) > 0.01)
    assert first[~apart, 1] == pytest.approx(others[~apart, 1], abs=1e-6)


def test_without_branches_every_impact_counts_alike(tmp_path):
    dots, _, rows, _ = drawn(tmp_path, REDUCED.format(within=[0.5, 0.85]))
    assert set(dots) == {"simulated: B at every impact"}
    assert len(dots["simulated: B at every impact"]) == 24


@pytest.mark.parametrize("over", [False, True])
def test_no_impacts_no_entry_without_dots(tmp_path, over):
    """Below C = 0.25 the absorber slides or sticks."""
    dots, legend, _, _ = drawn(tmp_path, REDUCED.format(within=[0.12, 0.24]), over)
    assert set(dots) == {"simulated: no impacts"} and not len(dots["simulated: no impacts"])
    assert "simulated: no impacts" in legend and not any("B at" in entry for entry in legend)
