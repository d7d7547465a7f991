"""Charts: loci none twice, points on them, regions, kept in files, resumed, from the command line."""

import copy
import json
from dataclasses import replace

import numpy as np
import pytest

import contvines as cv
from contvines.command.cli import app
from contvines.loci.table import chart_summary, table


def cubic(u, p):
    return np.array([p.a + p.b * u[0] - u[0] ** 3])


@pytest.fixture(scope="module")
def graph():
    problem = cv.AlgebraicProblem(cubic, [-1.2], {"a": -0.5, "b": 1.0}, parameter="a", spectrum="flow")
    return cv.diagram(problem, over="a", within=(-1.0, 1.0), depth=0)


@pytest.fixture(scope="module")
def chart(graph):
    return cv.chart(graph, over="b", within=(-0.5, 1.5))


def test_two_folds_of_one_curve_are_one_locus(graph, chart):
    assert len(graph.of_kind("fold")) == 2
    assert [locus.kind for locus in chart.loci.values()] == ["fold"]
    assert [point.kind for point in chart.points.values()] == ["cusp"]
    assert chart.points["CP1"].coefficients["c"] == pytest.approx(-1.0, abs=1e-9)  # u' = a + b u - u^3
    assert chart.points["CP1"].on == [next(iter(chart.loci))]
    assert chart.finished and chart.parameters == ("a", "b")


def test_the_wedge_of_the_cusp_is_a_region_of_its_own(chart):
    # area between a = -+ 2 (b/3)^(3/2) for 0 < b < 1.5, cut at |a| = 1, as a share of the rectangle 2 x 2
    b = np.linspace(0.0, 1.5, 20001)
    area = np.trapezoid(2 * np.minimum(2 * (b / 3) ** 1.5, 1.0), b) / 4.0
    shares = sorted(region.share for region in chart.regions)
    assert len(shares) == 2
    assert shares[0] == pytest.approx(area, abs=0.01)
    assert sorted(region.words for region in chart.regions) == [["2 x equilibrium"], ["equilibrium"]]
    for region in chart.regions:  # several places of each, on the right side of the cusp's curve, which agree
        places = [region.at, *(place["at"] for place in region.elsewhere)]
        assert len({tuple(place) for place in places}) >= 3 and not region.others
        inside = [b > 0.0 and abs(a) < 2.0 * (b / 3.0) ** 1.5 for a, b in places]
        assert all(inside) if region.words == ["2 x equilibrium"] else not any(inside)


def test_the_same_in_a_few_lines(chart):
    """A locus of folds, a cusp at (0, 0), and the two regions as the table of the chart has them."""
    told = chart_summary(chart, 100).splitlines()
    rows = [line.split() for line in told]
    assert ["fold", "1"] in [row[:2] for row in rows] and ["cusp", "1", "0", "0"] in rows
    assert [line for line in table(chart, 100).splitlines() if "%" in line] == [
        line for line in told if "%" in line
    ]


def test_json_is_the_documented_one(chart):
    data = json.loads(json.dumps(chart.to_dict()))
    assert data["parameters"] == ["a", "b"]
    (locus,) = data["loci"]
    assert {"label", "kind", "values", "real", "ended"} <= set(locus)
    assert len(locus["values"]) == len(locus["real"]) and len(locus["ended"]) == 2
    (point,) = data["points"]
    assert point["kind"] == "cusp" and set(point["value"]) == {"a", "b"}
    assert {"label", "on", "coefficients", "real"} <= set(point)


def test_a_locus_that_is_virtual_all_along_is_drawn_dotted(chart, tmp_path):
    virtual = copy.copy(chart)
    virtual.loci = {
        label: replace(locus, real=np.zeros(len(locus), bool)) for label, locus in chart.loci.items()
    }
    figure = virtual.plot()
    figure.savefig(tmp_path / "chart.png")
    (line,) = (
        line for line in figure.axes[0].lines if len(line.get_xdata()) == len(next(iter(chart.loci.values())))
    )
    assert line.get_linestyle() == ":" and np.isfinite(line.get_ydata()).all()


def test_a_chart_is_kept_in_a_file(chart, tmp_path):
    chart.save(tmp_path / "cusp.vines")
    other = cv.load(tmp_path / "cusp.vines")
    assert json.dumps(other.to_dict()) == json.dumps(chart.to_dict())
    assert str(other) == str(chart)


def test_orbits_of_a_chart_by_label(chart, tmp_path):
    from typer.testing import CliRunner

    path = tmp_path / "cusp.vines"
    chart.save(path)
    with pytest.raises(ValueError, match="holds a chart"):
        cv.Graph.load(path)
    (locus,), (point,) = chart.loci, chart.points

    def refusal(*label):
        return str(CliRunner().invoke(app, ["orbit", str(path), *label]).exception)

    assert f"{point}, {locus}" in refusal()
    assert "single point" in refusal(f"{point}:0")
    assert "numbered from 0" in refusal(f"{locus}:{len(chart.loci[locus])}")


@pytest.mark.slow
def test_command_line(tmp_path, monkeypatch, capsys):
    from typer.testing import CliRunner

    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.toml").write_text(
        '[model]\nname = "absorber"\nrestitution = 0.76\nfriction = 0.5\ngravity = 0.211\nmass_ratio = 0.006\n'
        '[start]\nword = "LR"\nperiods = 1\namplitude = 0.55\n'
        '[continue]\nparameter = "amplitude"\nwithin = [0.2, 0.8]\ndepth = 0\n'
        '[chart]\nparameter = "friction"\nwithin = [0.4, 0.6]\n'
    )
    result = CliRunner().invoke(app, ["chart", "study.toml", "--plot", "chart.png"])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "chart.png").exists() and (tmp_path / "study-chart.vines").exists()
    file = cv.load(tmp_path / "study-chart.vines")
    assert file.notation.keys() == set(
        file.parameters
    )  # labels of axes, whether its problems can be built again or not
    shown = CliRunner().invoke(app, ["show", "study-chart.vines", "--json"])
    data = json.loads(shown.output)
    assert data["parameters"] == ["amplitude", "friction"]
    assert {"fold", "symmetry-breaking"} <= {locus["kind"] for locus in data["loci"]}
    assert any("LR" in region["words"] for region in data["regions"])
    again = CliRunner().invoke(app, ["chart", "study.toml", "-q"])
    assert again.exit_code == 0
    result = CliRunner().invoke(
        app, ["locus", "study.vines", "LP1", "--over", "gravity", "--within", "0.1", "0.3"]
    )
    assert result.exit_code == 0 and "fold" in result.output
    bad = CliRunner().invoke(
        app, ["locus", "study.vines", "LP9", "--over", "gravity", "--within", "0.1", "0.3"]
    )
    assert "LP9 is no label of it" in str(bad.exception)
