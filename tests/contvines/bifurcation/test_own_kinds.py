"""Kinds of special points of the user's own: located, labelled, tabulated, drawn, kept in files, named in studies, followed in two parameters."""

import runpy
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

import contvines as cv
from contvines.command.study import read_study
from tests.contvines.loci.systems import BAZYKIN_DOUBLE_ZERO, bazykin
from tests.contvines.studies import PAPER

EXAMPLE = Path(__file__).parents[3] / "examples" / "neutral_saddle.py"


@pytest.fixture(scope="module")
def example():
    return runpy.run_path(str(EXAMPLE))["main"]


def with_kind(problem, kind, within=(0.0, 1.0), over=None):
    return cv.diagram(problem, over=over, within=within, depth=0, kinds=[*cv.KINDS, kind])


def saddle(delta, guess):
    """(x, y, alpha) where both rates and the trace of the Jacobian vanish, by mpmath with symbols of its own."""

    def zero(x, y, alpha):
        eaten = x * y / (1 + alpha * x)
        trace = 1 - y / (1 + alpha * x) ** 2 - x / 50 - 1 + x / (1 + alpha * x) - 2 * delta * y
        return [x - eaten - x**2 / 100, -y + eaten - delta * y**2, trace]

    with mp.workdps(30):
        return [float(value) for value in mp.findroot(zero, guess)]


@pytest.mark.parametrize("delta", [0.15, 0.17, 0.1])
def test_neutral_saddles_of_bazykins_model(example, delta):
    """Between the two folds (at 0.17 as close as 1.3e-4 to one), and on the axis y = 0 at x = 100, where the other eigenvalue is -1."""
    graph = example(delta)
    inner, axis = sorted(graph.of_kind("neutral-saddle"), key=lambda point: -point.u[1])
    x, y, alpha = saddle(delta, [*inner.u, inner.value])
    assert [inner.value, *inner.u] == pytest.approx([alpha, x, y], abs=1e-9)
    assert y > 0.1 and inner.value == pytest.approx(alpha, abs=1e-11)
    assert axis.value == pytest.approx(0.49, abs=1e-12)
    for point in (inner, axis):
        assert sum(point.multipliers) == pytest.approx(0.0, abs=1e-9)
        assert np.abs(point.multipliers.imag).max() == 0.0
    (hopf,) = graph.of_kind("hopf")
    assert abs(hopf.multipliers[0].imag) > 0.1
    assert graph.of_kind("neutral-saddle") == [graph["NSD1"], graph["NSD2"]]


def test_the_kind_is_in_tables_pictures_and_files(example, tmp_path):
    graph = example()
    cv.save(graph, tmp_path / "saddles.vines")
    for each in (graph, cv.load(tmp_path / "saddles.vines")):
        assert "neutral-saddle" in str(each) and each.kind("neutral-saddle").text == "neutral saddle"
        assert each["NSD1"].value == graph["NSD1"].value
        legend = each.plot(y="u1").axes[0].get_legend()
        assert "neutral saddle" in [text.get_text() for text in legend.get_texts()]


def test_a_zero_that_comes_in_pairs_is_seen():
    """On the line u = p the kind's number is (p - 0.5)^2 - 1e-4: zero at 0.49 and 0.51, one step apart."""
    kind = cv.Kind("near-half", "NH", test=lambda point: (point.value - 0.5) ** 2 - 1e-4)
    graph = with_kind(cv.AlgebraicProblem(lambda u, p: u - p, [0.0], 0.0), kind)
    assert [p.value for p in graph.of_kind("near-half")] == pytest.approx([0.49, 0.51], abs=1e-11)


def test_a_kind_may_end_branches_and_tell_its_normal_form():
    kind = cv.Kind(
        "quarter", "QU", test=lambda point: point.u[0] - 0.25, ends=True,
        classify=lambda point: ("supercritical", 2.0 * point.value),
    )  # fmt: skip
    graph = with_kind(cv.AlgebraicProblem(lambda u, p: u - p**2, [0.0], 0.0), kind)
    point = graph["QU1"]
    assert point.value == pytest.approx(0.5, abs=1e-12) and graph["B1"].range[1] == point.value
    assert (point.criticality, point.coefficient) == ("supercritical", pytest.approx(1.0))


def test_only_the_kinds_asked_for_are_looked_for():
    problem = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1, [1.0], 0.0)
    without = [kind for kind in cv.KINDS if kind.name != "fold"]
    assert not cv.diagram(problem, within=(-2.0, 2.0), kinds=without).special
    assert len(cv.diagram(problem, within=(-2.0, 2.0)).of_kind("fold")) == 2


def test_a_test_that_is_nowhere_a_number_is_told():
    nothing = cv.Kind("nothing", "NO", test=lambda point: float("nan"))
    with pytest.warns(UserWarning, match="kind nothing: its test is not a finite number on any branch"):
        with_kind(cv.AlgebraicProblem(lambda u, p: u - p, [0.5], 0.5), nothing)


def test_studies_name_kinds_in_a_file(tmp_path):
    """A change of it is one of the study."""
    file, path = tmp_path / "neutral_saddle.py", tmp_path / "study.toml"
    file.write_text(EXAMPLE.read_text())
    path.write_text(PAPER.replace("depth = 0", 'kinds = "neutral_saddle.py:NEUTRAL_SADDLE"'))
    before = read_study(path).fingerprint()
    file.write_text(EXAMPLE.read_text() + "\n# changed\n")
    assert read_study(path).fingerprint() != before
    path.write_text(path.read_text().replace(":NEUTRAL_", ":"))
    with pytest.raises(ValueError, match="has no kind 'SADDLE'; it has NEUTRAL_SADDLE"):
        read_study(path)


# ------------------------------------------------------------------ in two parameters
def test_neutral_saddles_are_followed(example, tmp_path):
    """Along the locus, read from a file, trace and residual stay zero: solved anew by mpmath."""
    point, file = example()["NSD1"], tmp_path / "c.vines"
    cv.chart(example(), "delta", (0.05, 0.3), regions=False, kinds=[point.own_kind]).save(file)
    locus = cv.load(file, kinds=[point.own_kind])["NSD1"]
    assert point.value == pytest.approx(locus.at(0.15)[-1], abs=1e-9)
    assert locus.kind == "neutral-saddle" and not locus.points
    values = locus.values
    for (alpha, delta), (x, y, _) in zip(values[::7], locus.branch.points[::7]):
        assert [x, y, alpha] == pytest.approx(saddle(delta, [x, y, alpha]), abs=1e-8 * max(1.0, x))
    # both ways from the start: saddles at one end of the interval of delta, Hopf points at the other
    assert sorted(values[[0, -1], 1]) == pytest.approx([0.05, 0.05])
    assert values[:, 1].max() > 0.2


def test_a_zero_trace_on_a_locus_of_folds_is_a_bogdanov_takens_point():
    problem = cv.AlgebraicProblem(bazykin, [20.0, 5.5], {"alpha": 0.4, "delta": 0.15}, spectrum="flow")
    graph = cv.diagram(problem, over="alpha", within=(0.3, 0.6))
    trace = cv.Kind("zero-trace", "ZT", test=lambda point: np.trace(point.jacobian))
    never = cv.Kind("never", "NEV", test=trace.test, verify=lambda point: point.parameters["delta"] < 0.1)
    found = cv.locus(graph["LP2"], over="delta", within=(0.01, 0.4), kinds=[*cv.KINDS, trace, never]).points
    assert {"ZT1", "BT1"} == set(found)
    for point in found.values():
        assert point.value == pytest.approx(BAZYKIN_DOUBLE_ZERO, rel=1e-10)


def test_cycles_of_a_given_period_are_followed_on_their_mesh():
    """On the circle r = 1 the angle turns at the rate w (1 + a x): the period is 2 pi / (w sqrt(1 - a^2))."""

    def rates(x, p):
        growth, turn = 1 - x[0] ** 2 - x[1] ** 2, p.w * (1 + p.a * x[0])
        return [growth * x[0] - turn * x[1], turn * x[0] + growth * x[1]]

    def slow(point):
        return point.measure("period") - 8.0

    kind = cv.Kind("slow", "SLW", test=slow, locus=slow)
    flow = cv.FlowProblem(rates, [0.0, 0.0], {"w": 1.0, "a": 0.3})
    graph = with_kind(flow.attractor([1.0, 0.0]), kind, (0.5, 2.0), "w")
    w, a = cv.locus(graph["SLW1"], over="a", within=(0.0, 0.9)).values.T
    assert {0.0, 0.9} == {a[0], a[-1]}
    assert w == pytest.approx(np.pi / 4 / np.sqrt(1 - a * a), abs=1e-9)
