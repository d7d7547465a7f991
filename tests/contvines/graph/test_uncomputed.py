"""Stability that nobody has computed is a third state: neither stable nor unstable, wherever it is asked for.

Of u' = p - u every equilibrium is stable (its eigenvalue is -1); of F = p - u alone nothing is known.
"""

import csv
import json

import numpy as np
import pytest

import contvines as cv
from contvines.graph.persistence import graph_entries, graph_from_entries
from contvines.plots.network import plot_network
from contvines.report.contents import contents


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


def test_in_tables_and_json(unknown, known):
    assert "not computed" in str(unknown) and "not computed" not in str(known)
    assert "not computed" in unknown["B1"]._repr_html_()
    assert json.loads(json.dumps(unknown.to_dict()))["branches"][0]["stable"] is None
    assert known.to_dict()["branches"][0]["stable"] == [[0.0, 2.0]]


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


def test_of_an_older_file_that_called_it_unstable(unknown):
    entries: dict = {}
    for kind, key, content in graph_entries(unknown):
        if kind == "branch":
            content = {**content, "stable": np.zeros(len(unknown["B1"]), dtype=bool)}
        entries.setdefault(kind, {})[key] = content
    assert graph_from_entries(entries)["B1"].stable is None


def test_in_pictures(unknown, known):
    for graph, word in ((unknown, "stability not computed"), (known, "stable")):
        (axes,) = graph.plot().axes
        texts = [text.get_text() for text in axes.get_legend().get_texts()]
        assert word in texts and "unstable" not in texts
        assert {drawn.get_linestyle() for drawn in axes.lines if len(drawn.get_xdata()) > 2} == {"-"}
    assert "stability not computed" in plot_network(unknown).axes[0].get_title(loc="left")


def test_in_reports(unknown, known):
    for graph, told in ((unknown, None), (known, [1] * len(known["B1"]))):
        (branch,) = contents(graph, "it.vines")["branches"]
        assert branch["stable_points"] == told
