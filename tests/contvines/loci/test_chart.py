"""Charts: loci none twice, points on them, regions, kept in files, from the command line."""

import copy
import json
from dataclasses import replace

import numpy as np
import pytest

import contvines as cv
from contvines.loci.table import chart_summary, table
from tests.contvines.studies import PAPER


@pytest.fixture(scope="module")
def graph():
    problem = cv.AlgebraicProblem(
        lambda u, p: p.a + p.b * u - u**3, [-1.2], {"a": -0.5, "b": 1.0}, spectrum="flow"
    )
    return cv.diagram(problem, over="a", within=(-1.0, 1.0), depth=0)


@pytest.fixture(scope="module")
def chart(graph):
    return cv.chart(graph, over="b", within=(-0.5, 1.5))


def test_two_folds_of_one_curve_are_one_locus(graph, chart):
    assert len(graph.of_kind("fold")) == 2
    (locus,), (cusp,) = chart.loci.values(), chart.points.values()
    assert (locus.kind, cusp.kind, cusp.on) == ("fold", "cusp", [locus.label])
    assert cusp.coefficients["c"] == pytest.approx(-1.0, abs=1e-9)  # u' = a + b u - u^3
    assert chart.finished and chart.parameters == ("a", "b")
    # a locus of folds, a cusp at (0, 0), and the regions, in a few lines and in the table
    told = chart_summary(chart, 100).splitlines()
    rows = [line.split() for line in told]
    assert ["fold", "1"] in [row[:2] for row in rows] and ["cusp", "1", "0", "0"] in rows
    assert [line for line in table(chart, 100).splitlines() if "%" in line] == [
        line for line in told if "%" in line
    ]


def test_the_wedge_of_the_cusp_is_a_region_of_its_own(chart):
    # area between a = -+ 2 (b/3)^(3/2) for 0 < b < 1.5, cut at |a| = 1, as a share of the rectangle 2 x 2
    b = np.linspace(0.0, 1.5, 20001)
    area = np.trapezoid(2 * np.minimum(2 * (b / 3) ** 1.5, 1.0), b) / 4.0
    wedge, rest = sorted(chart.regions, key=lambda region: region.share)
    assert wedge.share == pytest.approx(area, abs=0.01)
    assert (wedge.words, rest.words) == (["2 x equilibrium"], ["equilibrium"])
    for region in chart.regions:  # several places of each, on the right side of the cusp's curve, which agree
        places = [region.at, *(place["at"] for place in region.elsewhere)]
        assert len({tuple(place) for place in places}) >= 3 and not region.others
        assert {b > 0.0 and abs(a) < 2.0 * (b / 3.0) ** 1.5 for a, b in places} == {region is wedge}


def test_json_is_the_documented_one(chart):
    data = json.loads(json.dumps(chart.to_dict()))
    assert data["parameters"] == ["a", "b"]
    (locus,), (point,) = data["loci"], data["points"]
    assert {"label", "kind", "values", "real", "ended"} <= set(locus)
    assert len(locus["values"]) == len(locus["real"]) and len(locus["ended"]) == 2
    assert {"label", "on", "coefficients", "real"} <= set(point)
    assert point["kind"] == "cusp" and set(point["value"]) == {"a", "b"}


def test_a_locus_that_is_virtual_all_along_is_drawn_dotted(chart):
    ((label, locus),) = chart.loci.items()
    virtual = copy.copy(chart)
    virtual.loci = {label: replace(locus, real=np.zeros(len(locus), bool))}
    (line,) = (line for line in virtual.plot().axes[0].lines if len(line.get_xdata()) == len(locus))
    assert line.get_linestyle() == ":" and np.isfinite(line.get_ydata()).all()


def test_a_chart_is_kept_in_a_file_and_has_orbits_by_label(chart, run):
    chart.save("cusp.vines")
    other = cv.load("cusp.vines")
    assert json.dumps(other.to_dict()) == json.dumps(chart.to_dict())
    assert str(other) == str(chart)
    with pytest.raises(ValueError, match="holds a chart"):
        cv.Graph.load("cusp.vines")
    (locus,), (point,) = chart.loci, chart.points
    for label, said in (
        ([], f"{point}, {locus}"),
        ([f"{point}:0"], "single point"),
        ([f"{locus}:{len(chart.loci[locus])}"], "numbered from 0"),
    ):
        assert said in run("orbit", "cusp.vines", *label)[2]


@pytest.mark.slow
def test_command_line(tmp_path, run):
    chart = '[chart]\nparameter = "friction"\nwithin = [0.4, 0.6]\n'
    (tmp_path / "study.toml").write_text(PAPER.replace("1.2]", "0.8]") + chart)
    assert run("chart", "study.toml", "--plot", "chart.png")[0] == 0
    assert (tmp_path / "chart.png").exists()
    file = cv.load("study-chart.vines")
    # labels of axes, whether its problems can be built again or not
    assert file.notation.keys() == set(file.parameters)
    data = json.loads(run("show", "study-chart.vines", "--json")[1])
    assert data["parameters"] == ["amplitude", "friction"]
    assert {"fold", "symmetry-breaking"} <= {locus["kind"] for locus in data["loci"]}
    assert any("LR" in region["words"] for region in data["regions"])
    assert run("chart", "study.toml", "-q")[0] == 0
    for label, said in (
        ("LP1", "fold"),
        ("LP9", "LP9 is no label of it; its special points are"),
        ("EP1", "EP1 is no special point of the motion"),
        ("B1", "B1 is a branch"),
    ):
        status, out, err = run("locus", "study.vines", label, "--over", "gravity", "--within", 0.1, 0.3)
        assert (status == 0) == (label == "LP1") and said in out + err


@pytest.mark.slow
def test_two_folds_of_two_cells_cross_in_closed_form():
    # x' = a + b x - x^3 folds at a = 2 (b/3)^(3/2); y' = a - c + y - y^3 folds at a = c + 2/27^(1/2), whatever b is:
    # both at once where the two values are one
    c = 0.369

    def f(u, p):
        return [p.a + p.b * u[0] - u[0] ** 3, p.a - c + u[1] - u[1] ** 3]

    problem = cv.AlgebraicProblem(f, [-1.2, -1.3], {"a": -0.528, "b": 1.0}, spectrum="flow")
    graph = cv.diagram(problem, over="a", within=(-1.2, 1.2), depth=0)
    chart = cv.chart(graph, over="b", within=(0.6, 2.2), regions=False)
    second = c + 2 / 27**0.5
    b = 3 * (second / 2) ** (2 / 3)
    values = [(c["value"]["a"], c["value"]["b"]) for c in chart.crossings]
    assert any(np.allclose(value, (second, b), atol=1e-9) for value in values), values
    assert chart.to_dict()["crossings"] == chart.crossings
