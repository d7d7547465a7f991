"""Stability that nobody has computed is a third state: neither stable nor unstable, wherever it is asked for.

Of u' = p - u every equilibrium is stable (its eigenvalue is -1); of F = p - u alone nothing is known.
"""

import csv

import pytest

import contvines as cv


def traced(spectrum):
    problem = cv.AlgebraicProblem(lambda u, p: p - u, [1.0], 1.0, spectrum=spectrum)
    return cv.diagram(problem, within=(0.0, 2.0), depth=0)


def test_as_data():
    branch = traced("none")["B1"]
    assert branch.stable is None and branch.pieces() == [(0, len(branch) - 1, None)]
    assert branch.stable_intervals() == [] and traced("flow")["B1"].stable_intervals() == [(0.0, 2.0)]
    assert {point.stable for point in cv.trace(branch.problem, (0.0, 2.0))} == {None}
    with pytest.raises(ValueError, match="its stability is not computed"):
        cv.robustness(branch, 1.0)


@pytest.mark.parametrize(("spectrum", "told"), [("none", ""), ("flow", "1")])
def test_in_files(tmp_path, spectrum, told):
    graph, known = traced(spectrum), spectrum == "flow"
    for ending in ("csv", "mat", "graphml"):
        graph.export(tmp_path / f"points.{ending}")
    with (tmp_path / "points.csv").open() as file:
        assert {row["stable"] for row in csv.DictReader(file)} == {told}
    graph.save(tmp_path / "a.vines")
    assert (cv.load(tmp_path / "a.vines")["B1"].stable is not None) is known
    frame, data = graph["B1"].to_pandas()["stable"], graph["B1"].to_xarray()
    assert frame.all() and data["stable"].all() if known else frame.isna().all() and "stable" not in data
