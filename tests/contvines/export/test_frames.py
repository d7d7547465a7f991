"""Data frames and data sets hold the branches' own numbers."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines import fakes
from tests.contvines.loci.systems import henon

pytest.importorskip("pandas")


@pytest.fixture
def graph():
    return fakes.pitchfork_graph()


def test_a_graph_as_a_frame(graph):
    frame = graph.to_pandas()
    assert list(frame.index.names) == ["branch", "index"]
    side = frame.loc["B2"]
    assert np.allclose(side["u0"] ** 2, side["p"]) and np.allclose(side["multiplier0_re"], -2 * side["p"])
    assert frame["stable"].dtype == bool
    assert set(frame["special"]) - {""} == {"BP1", "EP1"}


def test_a_graph_as_a_data_set_has_every_point_of_every_branch(graph):
    xarray = pytest.importorskip("xarray")
    data = graph.to_xarray()
    assert isinstance(data, xarray.Dataset) and data.sizes["row"] == sum(map(len, graph.branches.values()))
    own = data.where(data["branch"] == "B2", drop=True)
    assert np.allclose(own["p"], graph["B2"].values)
    assert data.attrs["parameter"] == "p"


def test_a_chart_as_a_frame_has_every_point_of_every_locus():
    problem = cv.MapProblem(henon, [0.63, 0.19], {"a": 0.2, "b": 0.3})
    chart = cv.chart(cv.diagram(problem, within=(0.0, 0.6), depth=0), "b", (0.1, 0.5), regions=False)
    frame = chart.to_pandas()
    flips = frame[frame["kind"] == "period-doubling"]
    assert len(flips) > 2 and np.allclose(flips["a"], 0.75 * (1 - flips["b"]) ** 2, atol=1e-9)
    pytest.importorskip("xarray")
    chart.units["a"] = "mm"
    data = chart.to_xarray()
    assert data.sizes == {"row": len(frame)} and list(data.attrs["parameters"]) == ["a", "b"]
    assert data["locus"].values.tolist() == frame.index.get_level_values("locus").tolist()
    assert np.array_equal(data["a"], frame["a"])
    assert data["a"].attrs["units"] == "mm" and "units" not in data["b"].attrs


def test_special_points_as_a_frame(graph):
    frame = graph.points_to_pandas()
    assert list(frame.index) == list(graph.special)
    assert list(frame["branch"]) == [point.branch for point in graph.special.values()]
