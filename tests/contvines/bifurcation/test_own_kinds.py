"""Kinds of special points of the user's own: located, labelled, tabulated, drawn, exported, kept in files, named in studies."""

import importlib.util
import json
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

import contvines as cv

EXAMPLE = Path(__file__).parents[3] / "examples" / "neutral_saddle.py"


def loaded():
    spec = importlib.util.spec_from_file_location("neutral_saddle", EXAMPLE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def saddle(delta, guess):
    """(x, y, alpha) where both rates and the trace of the Jacobian vanish, by mpmath with symbols of its own."""

    def zero(x, y, alpha):
        eaten = x * y / (1 + alpha * x)
        trace = 1 - y / (1 + alpha * x) ** 2 - x / 50 - 1 + x / (1 + alpha * x) - 2 * delta * y
        return [x - eaten - x**2 / 100, -y + eaten - delta * y**2, trace]

    with mp.workdps(30):
        return [float(value) for value in mp.findroot(zero, guess)]


@pytest.mark.parametrize("delta", [0.15, 0.17, 0.1])
def test_neutral_saddles_of_bazykins_model(delta):
    """Between the two folds (at 0.17 as close as 1.3e-4 to one), and on the axis y = 0 at x = 100, where the other eigenvalue is -1."""
    module = loaded()
    graph = module.main(delta)
    inner, axis = sorted(graph.of_kind("neutral-saddle"), key=lambda point: -point.u[1])
    x, y, alpha = saddle(delta, [*inner.u, inner.value])
    assert [inner.value, *inner.u] == pytest.approx([alpha, x, y], abs=1e-9)
    assert y > 0.1 and inner.value == pytest.approx(alpha, abs=1e-11)
    assert axis.value == pytest.approx(0.49, abs=1e-12)
    for point in (inner, axis):
        assert sum(point.multipliers) == pytest.approx(0.0, abs=1e-9)
        assert np.abs(point.multipliers.imag).max() == 0.0
        assert point.label.startswith("NSD")
    hopf = graph.of_kind("hopf")
    assert len(hopf) == 1 and abs(hopf[0].multipliers[0].imag) > 0.1
    assert graph.of_kind("neutral-saddle") == [graph["NSD1"], graph["NSD2"]]


def test_the_kind_is_in_tables_pictures_exports_and_files(tmp_path):
    graph = loaded().main()
    assert "neutral-saddle" in str(graph) and "NSD1" in str(graph)
    figure = graph.plot(y="u1")
    assert "neutral saddle" in [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    cv.save(graph, tmp_path / "saddles.vines")
    again = cv.load(tmp_path / "saddles.vines")
    assert again["NSD1"].value == graph["NSD1"].value
    assert again.kind("neutral-saddle").text == "neutral saddle"
    assert [point.label for point in again.of_kind("neutral-saddle")] == ["NSD1", "NSD2"]
    kinds = {entry["label"]: entry["kind"] for entry in json.loads(json.dumps(graph.to_dict()))["special"]}
    assert kinds["NSD1"] == "neutral-saddle"


def test_a_zero_that_comes_in_pairs_is_seen():
    """On the line u = p the kind's number is (p - 0.5)^2 - 1e-4: zero at 0.49 and 0.51, one step apart."""
    problem = cv.AlgebraicProblem(lambda u, p: u - p, [0.0], 0.0)
    kind = cv.Kind("near-half", "NH", test=lambda point: (point.value - 0.5) ** 2 - 1e-4)
    graph = cv.diagram(problem, within=(0.0, 1.0), kinds=[*cv.KINDS, kind])
    assert [p.value for p in graph.of_kind("near-half")] == pytest.approx([0.49, 0.51], abs=1e-11)


def test_a_kind_may_end_branches_and_tell_its_normal_form():
    problem = cv.AlgebraicProblem(lambda u, p: u - p**2, [0.0], 0.0)
    kind = cv.Kind(
        "quarter",
        "QU",
        test=lambda point: point.u[0] - 0.25,
        classify=lambda point: ("supercritical", 2.0 * point.value),
        ends=True,
    )
    graph = cv.diagram(problem, within=(0.0, 1.0), kinds=[*cv.KINDS, kind])
    point = graph["QU1"]
    assert point.value == pytest.approx(0.5, abs=1e-12)
    assert (point.criticality, point.coefficient) == ("supercritical", pytest.approx(1.0))
    assert graph["B1"].range[1] == point.value


def test_only_the_kinds_asked_for_are_looked_for():
    problem = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1, [1.0], 0.0)
    without = [kind for kind in cv.KINDS if kind.name != "fold"]
    assert not cv.diagram(problem, within=(-2.0, 2.0), kinds=without).special
    assert len(cv.diagram(problem, within=(-2.0, 2.0)).of_kind("fold")) == 2


STUDY = """
[model]
name = "model.py:flow"

[continue]
parameter = "alpha"
within = [0.3, 0.6]
kinds = "neutral_saddle.py:{name}"
"""
MODEL = """
import contvines as cv
from neutral_saddle import bazykin

flow = cv.FlowProblem(lambda x, p: bazykin(x, p), [20.0, 5.5], {"alpha": 0.4, "delta": 0.15})
"""


def test_studies_name_kinds_in_a_file(tmp_path, monkeypatch):
    from contvines.command.compose import first_orbit, run_diagram
    from contvines.command.study import read_study

    (tmp_path / "neutral_saddle.py").write_text(EXAMPLE.read_text())
    (tmp_path / "model.py").write_text(MODEL)
    (tmp_path / "study.toml").write_text(STUDY.format(name="NEUTRAL_SADDLE"))
    monkeypatch.syspath_prepend(str(tmp_path))
    study = read_study(tmp_path / "study.toml")
    graph = run_diagram(study, first_orbit(study))
    inner = max(graph.of_kind("neutral-saddle"), key=lambda point: point.u[1])
    assert inner.value == pytest.approx(saddle(0.15, [*inner.u, inner.value])[2], abs=1e-10)
    before = study.fingerprint()
    (tmp_path / "neutral_saddle.py").write_text(EXAMPLE.read_text() + "\n# changed\n")
    assert read_study(tmp_path / "study.toml").fingerprint() != before
    (tmp_path / "study.toml").write_text(STUDY.format(name="SADDLE"))
    with pytest.raises(ValueError, match="has no kind 'SADDLE'; it has NEUTRAL_SADDLE"):
        read_study(tmp_path / "study.toml")


def test_a_kind_with_a_condition_is_followed_in_two_parameters():
    """Along the locus trace and residual stay zero; it meets the point where the determinant vanishes, too, solved anew by mpmath."""
    module = loaded()
    locus = cv.locus(module.main()["NSD1"], over="delta", within=(0.05, 0.3))
    assert locus.kind == "neutral-saddle" and not locus.points
    values, points = locus.values, locus.branch.points
    for (alpha, delta), (x, y, _) in zip(values[::7], points[::7]):
        found = saddle(delta, [x, y, alpha])
        assert [x, y, alpha] == pytest.approx(found, abs=1e-8 * max(1.0, x))
    # both ways from the start: saddles at one end of the interval of delta, Hopf points at the other
    assert sorted(values[[0, -1], 1]) == pytest.approx([0.05, 0.05])
    assert values[:, 1].max() > 0.2


def test_a_test_that_is_nowhere_a_number_is_told():
    problem = cv.AlgebraicProblem(lambda u, p: u - p, [0.5], 0.5)
    nothing = cv.Kind("nothing", "NO", test=lambda point: float("nan"))
    with pytest.warns(UserWarning, match="kind nothing: its test is a number on no branch"):
        cv.diagram(problem, within=(0.0, 1.0), kinds=[*cv.KINDS, nothing])
