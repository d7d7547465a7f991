"""What is measured of flows that were loaded without their functions: x = sqrt(mu) (cos t, sin t), which needs no function."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.flows.shooting import landau


def normal():
    # a function without a name of its own is not found again
    return cv.FlowProblem(lambda x, p: landau(x, p), [0.0, 0.0], {"mu": -0.5}, states=("x", "y"))


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    path = tmp_path_factory.mktemp("flow") / "normal.vines"
    cv.diagram(normal(), over="mu", within=(-1, 1)).save(path)
    return path


def test_measures_of_a_loaded_cycle(place):
    graph = cv.Graph.load(place)
    cycle, rest = graph.branches["B2"], graph.branches["B1"]
    assert cycle.problem is None
    radius = np.sqrt(cycle.values)
    assert cycle.measure("max x") == pytest.approx(radius, abs=1e-6)
    assert cycle.measure("min y") == pytest.approx(-radius, abs=1e-6)
    assert cycle.measure("mean x") == pytest.approx(0.0, abs=1e-6)
    assert cycle.measure("norm") == pytest.approx(radius, abs=1e-6)
    assert cycle.measure("period") == pytest.approx(2 * np.pi, abs=1e-6)
    for name in ("x", "max y", "u1", "norm"):
        assert rest.measure(name) == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(KeyError, match="loaded without its problem"):
        cycle.measure("x")


def test_a_loaded_graph_is_drawn_as_the_whole_one(place):
    axes = cv.Graph.load(place).plot().axes[0]
    assert axes.get_ylabel() == "max x"
    assert max(
        np.nanmax(line.get_ydata()) for line in axes.lines if np.size(line.get_ydata()) > 9
    ) == pytest.approx(1.0, abs=1e-6)


def test_files_of_auto_have_no_cycle_whose_flow_is_not_there(place):
    """A cycle is no equilibrium of as many states as its mesh has unknowns."""
    cv.Graph.load(place).export(place.with_suffix(".auto"))
    lines = place.with_name("s.normal").read_text().splitlines()
    heads = [line.split() for line in lines if len(line.split()) == 16 and "E" not in line]
    assert heads and {int(head[7]) for head in heads} == {3}  # two states and the time


def test_a_flow_is_attached_to_all_its_branches(place):
    """Liouville: the circle has the multiplier exp(-4 pi mu)."""
    graph = cv.Graph.load(place)
    cycle, hopf = graph.branches["B2"], graph.special["HB1"]
    with pytest.raises(ValueError, match="no problem attached"):
        cycle.orbit(5)
    graph.attach(normal())
    for i in (5, len(cycle) - 1):
        orbit, mu = cycle.orbit(i), cycle.values[i]
        assert orbit(0.3) @ orbit(0.3) == pytest.approx(mu, rel=1e-6)
        assert orbit.multipliers == pytest.approx([np.exp(-4 * np.pi * mu)], rel=1e-6)
    assert hopf.problem is not None and hopf.frequency == pytest.approx(1.0)
