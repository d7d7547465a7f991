"""Stability that nobody has computed is a third state: neither stable nor unstable, wherever it is asked for.

Of u' = p - u every equilibrium is stable (its eigenvalue is -1); of F = p - u alone nothing is known.
"""

import csv

import pytest

import contvines as cv


def line(u, p):
    return p - u


def traced(spectrum):
    problem = cv.AlgebraicProblem(line, [1.0], 1.0, spectrum=spectrum)
    return cv.diagram(problem, within=(0.0, 2.0), depth=0)


@pytest.fixture(scope="module")
def unknown():
    return traced("none")


@pytest.fixture(scope="module")
def known():
    return traced("flow")


def test_as_data(unknown, known):
    branch = unknown["B1"]
    assert branch.stable is None and branch.pieces() == [(0, len(branch) - 1, None)]
    assert branch.stable_intervals() == [] and known["B1"].stable_intervals() == [(0.0, 2.0)]
    problem = cv.AlgebraicProblem(line, [1.0], 1.0)
    assert {point.stable for point in cv.trace(problem, (0.0, 2.0))} == {None}
    with pytest.raises(ValueError, match="its stability is not computed"):
        cv.robustness(branch, 1.0)


def test_in_files(unknown, known, tmp_path):
    for graph, told in ((unknown, {""}), (known, {"1"})):
        graph.export(tmp_path / "points.csv")
        with (tmp_path / "points.csv").open() as file:
            assert {row["stable"] for row in csv.DictReader(file)} == told
        for ending in ("mat", "graphml"):
            graph.export(tmp_path / f"points.{ending}")
        name = tmp_path / f"{told}.vines"
        graph.save(name)
        assert (cv.load(name)["B1"].stable is None) is (graph is unknown)
    assert "stable" not in unknown["B1"].to_xarray() and known["B1"].to_xarray()["stable"].all()
    assert unknown["B1"].to_pandas()["stable"].isna().all() and known["B1"].to_pandas()["stable"].all()
