"""Every plot function draws on given axes and respects what the user asks of style, legend and size."""

import itertools
from dataclasses import replace
from functools import cache, partial

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

import contvines as cv
from contvines.graph.contents import Attractor
from contvines.plots import (
    plot_atlas,
    plot_basins,
    plot_circles,
    plot_diagram,
    plot_multipliers,
    plot_network,
    plot_portrait,
    plot_survey,
    plot_sweep,
)
from contvines.plots.measured import plot_calibration, plot_transient
from contvines.survey import Plan
from contvines.survey.results import Survey
from tests.contvines import fakes
from tests.contvines.loci.systems import henon

TIME = np.linspace(0.0, 1.5, 400)
DECAY = [
    ("time", "s", TIME),
    ("oscillator", "mm", np.sin(90 * TIME)),
    ("bare_oscillator", "mm", 2 * np.sin(90 * TIME)),
]
ENERGY = [("time", "s", TIME), ("energy", "", np.exp(-2 * TIME)), ("bare_energy", "", np.exp(-TIME))]
DOTS = [(x, x**2) for x in np.linspace(0, 1, 20)]


@cache
def basins():
    problem = cv.MapProblem(henon, [0.63, 0.19], {"a": 0.2, "b": 0.3})
    return cv.basins(problem.population(box=[(-2, 2), (-2, 2)]), at=0.2, points=8)


@cache
def circles():
    delayed = cv.MapProblem(lambda x, p: [p.r * x[0] * (1 - x[1]), x[0]], [0.4, 0.4], {"r": 1.7})
    return cv.diagram(delayed, within=(1.2, 2.4))["NS1"].circles(to=2.02)


GRAPH = fakes.pitchfork_graph()
ATLAS = fakes.pitchfork_graph()
ATLAS.attractors = [
    Attractor(value=v, word=w, periods=1, kind="periodic", branch=None, share=0.5)
    for v in (-0.5, 0.5)
    for w in ("LR", "tt")
]
PLAN = Plan({"gap": np.array([1.0, 2.0, 3.0])}, {"friction": np.array([0.1, 0.2])})
SURVEY = Survey(PLAN, {"peak": np.array([[1.0, 2.0], [2.0, 3.0], [3.0, 5.0]])}, np.full((3, 2), ""), {}, {})
LATE, LARGEST = "measured less computed [s]", "largest displacement of the oscillator [mm]"
# Names, and how many axes each wants
FUNCTIONS = {
    "diagram": (1, partial(plot_diagram, GRAPH)),
    "sweep": (1, partial(plot_sweep, DOTS, "p", GRAPH, "u0")),
    "sweep alone": (1, partial(plot_sweep, DOTS, "amplitude")),
    "network": (1, partial(plot_network, GRAPH)),
    "multipliers": (2, partial(plot_multipliers, GRAPH.branches["B2"])),
    "atlas": (2, partial(plot_atlas, ATLAS)),
    "basins": (1, lambda **options: plot_basins(basins(), **options)),
    "circles": (3, lambda **options: plot_circles(circles(), **options)),
    "portrait": (1, partial(plot_portrait, np.array([[0.0, 1.0], [1.0, 0.0]]))),
    "survey": (1, partial(plot_survey, SURVEY)),
    "transient": (1, partial(plot_transient, DECAY, np.linspace(0.1, 1.4, 30))),
    "decay": (1, partial(plot_transient, ENERGY)),
    "calibration": (1, partial(plot_calibration, TIME, 1e-5 * np.sin(9 * TIME), xlabel="t", ylabel=LATE)),
    "response": (1, partial(plot_calibration, TIME, 0.0 * TIME, TIME**2, xlabel="p", ylabel=LARGEST)),
}  # fmt: skip


@pytest.mark.parametrize("name", FUNCTIONS)
def test_it_draws_on_given_axes_and_pyplot_keeps_no_figure_of_ours(name):
    count, function = FUNCTIONS[name]
    before = plt.get_fignums()
    function()
    assert plt.get_fignums() == before
    figure, axes = plt.subplots(1, count, squeeze=False, figsize=(4 * count, 3))
    drawn = axes.ravel()
    others = len(figure.axes)
    assert function(axes=drawn[0] if count == 1 else drawn) is figure
    for one in drawn:
        assert one.lines or one.images or one.texts or one.patches or one.collections
    assert len(figure.axes) - others <= 1  # a bar of colours at most
    plt.close(figure)


@pytest.mark.slow
@pytest.mark.parametrize("name", ("diagram", "network", "atlas", "basins", "survey", "transient"))
def test_it_respects_the_users_style_and_settings_stay(name):
    function = FUNCTIONS[name][1]
    before = dict(mpl.rcParams)
    with mpl.rc_context({"axes.facecolor": "#ffeecc"}):
        assert function().axes[0].get_facecolor() == mpl.colors.to_rgba("#ffeecc")
    figure = function(style={"axes.facecolor": "#cceeff"})
    assert figure.axes[0].get_facecolor() == mpl.colors.to_rgba("#cceeff")
    assert dict(mpl.rcParams) == before


SIZES = [*((name, (3.4, 2.4)) for name in FUNCTIONS), ("diagram", (2.6, 2.2)), ("diagram", (10.0, 6.0))]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "size"), SIZES)
def test_nothing_is_cut_and_no_labels_touch_in_a_column_of_a_journal(name, size):
    figure = FUNCTIONS[name][1](figsize=size)
    figure.canvas.draw()
    page, window = figure.bbox, figure.axes[0].get_window_extent()
    assert window.width > 0.4 * page.width
    if name == "diagram":
        assert window.width > 0.5 * page.width and window.height > 0.35 * page.height
    for one in figure.axes:
        shown = [seen_ticks(axis) for axis in (one.xaxis, one.yaxis)] if one.axison else [[], []]
        for thing in (
            one.xaxis.label,
            one.yaxis.label,
            one.title,
            *one.texts,
            *legends_of(figure),
            *shown[0],
            *shown[1],
        ):
            box = thing.get_window_extent()
            if one.axison and thing.get_visible() and box.width > 1:
                assert box.x0 >= page.x0 - 2 and box.x1 <= page.x1 + 2, thing
                assert box.y0 >= page.y0 - 2 and box.y1 <= page.y1 + 2, thing
        boxes = sorted((label.get_window_extent() for label in shown[0]), key=lambda box: box.x0)
        assert all(a.x1 < b.x0 for a, b in itertools.pairwise(boxes))


def test_an_atlas_over_another_measure_has_two_axes():
    upper, lower = plot_atlas(ATLAS, "u0").axes
    assert (upper.get_xlabel(), lower.get_xlabel()) == ("u0", "p")


def test_circles_name_the_unit_of_the_parameter():
    assert plot_circles(replace(circles(), units={"r": "Hz"})).axes[2].get_xlabel() == "r [Hz]"


def legends_of(figure):
    return [*figure.legends, *(axes.get_legend() for axes in figure.axes if axes.get_legend())]


def seen_ticks(axis):
    """The labels of ticks that can be seen."""
    low, high = sorted(axis.get_view_interval())
    ticks = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
    return [tick.label1 for tick in ticks if tick.label1.get_visible() and tick.label1.get_text()]


@pytest.mark.slow
@pytest.mark.parametrize("name", ("diagram", "sweep", "atlas", "basins", "circles", "survey", "multipliers"))
def test_a_legend_can_be_left_out_or_put_somewhere(name):
    function = FUNCTIONS[name][1]

    assert legends_of(function(legend=False)) == []
    for legend in legends_of(function(legend="lower left")):
        box, frame = legend.get_window_extent(), legend.axes.get_window_extent()
        assert box.x0 - frame.x0 < frame.x1 - box.x1 and box.y0 - frame.y0 < 12
