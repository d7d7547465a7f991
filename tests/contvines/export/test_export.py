"""Exports: read back with independent readers, number for number."""

import csv
import json

import networkx
import numpy as np
import pytest
from scipy.io import loadmat

from contvines.export import export
from contvines.store import Store, load
from tests.contvines import fakes


@pytest.fixture
def graph():
    return fakes.pitchfork_graph()


@pytest.fixture
def written(tmp_path):
    """Exports a graph, and reads it back."""

    def go(graph, form):
        path = export(graph, form, tmp_path / f"g.{form}")
        if form == "csv":
            with path.open(newline="") as file:
                return list(csv.DictReader(file))
        if form == "mat":
            return loadmat(path, simplify_cells=True)
        if form == "graphml":
            return networkx.read_graphml(path, force_multigraph=True)
        text = path.read_text()
        assert "NaN" not in text and "Infinity" not in text
        return json.loads(text) if form == "json" else text

    return go


def test_csv_has_every_point_at_full_precision(graph, written):
    rows = written(graph, "csv")
    assert len(rows) == sum(len(b) for b in graph.branches.values())
    for branch in graph.branches.values():
        mine = [r for r in rows if r["branch"] == branch.label]
        assert [float(r["p"]) for r in mine] == branch.values.tolist()
        assert [float(r["u0"]) for r in mine] == branch.points[:, 0].tolist()
        assert [r["stable"] == "1" for r in mine] == branch.stable.tolist()
        found = [complex(float(r["multiplier0_re"]), float(r["multiplier0_im"])) for r in mine]
        assert found == branch.multipliers[:, 0].tolist()
    assert [(r["branch"], int(r["index"])) for r in rows if r["special"] == "BP1"] == [("B1", 20), ("B2", 0)]


class Measured:
    """A made-up problem: the measures double and triple, and one that cannot be obtained."""

    measure_names = ("double", "triple", "u0", "refused", "p")

    def measures(self, names, u, p):
        (name,) = names
        if name == "refused":
            raise ValueError("not for this problem")
        return {
            name: {"double": 2 * u[:, 0], "triple": np.where(p > 0.5, np.nan, 3 * u[:, 0])}.get(name, u[:, 0])
        }


def test_csv_and_mat_have_word_periods_and_measures(graph, written):
    branch = graph.branches["B2"]  # the parabola p = u^2
    branch.problem = Measured()
    branch.description = {"word": "LR", "periods": 3}
    rows = written(graph, "csv")
    head = list(rows[0])
    assert head[:8] == ["branch", "index", "p", "stable", "real", "margin", "special", "u0"]
    assert head[8:] == ["multiplier0_re", "multiplier0_im", "word", "periods", "norm", "double", "triple"]
    for row in rows:
        u, p = float(row["u0"]), float(row["p"])
        if row["branch"] != "B2":
            assert (row["word"], row["periods"], row["double"], row["triple"]) == ("",) * 4
            assert float(row["norm"]) == abs(u)
            continue
        assert (row["word"], row["periods"], row["norm"]) == ("LR", "3", "")
        assert float(row["double"]) == 2 * u
        assert row["triple"] == "" if p > 0.5 else float(row["triple"]) == 3 * u
    data = written(graph, "mat")["branches"]
    assert (data["B2"]["word"], data["B2"]["periods"]) == ("LR", 3)
    x = np.linspace(0, 1, 31)
    assert np.array_equal(data["B2"]["measures"]["double"], 2 * x)
    assert np.isnan(data["B2"]["measures"]["triple"]).sum() == np.sum(x**2 > 0.5)


def test_json_is_the_graphs_own_object_in_standard_json(graph, written):
    graph.special["BP1"].bracket = (float("nan"), float("inf"))
    data = written(graph, "json")
    assert [b["label"] for b in data["branches"]] == ["B1", "B2", "B3"]
    assert data["special"][0]["value"] == {"p": 0.0}
    assert data["special"][0]["bracket"] == [None, None]
    assert data["switches"][0]["from"] == "B1"


def test_graphml_is_read_back_by_networkx(graph, written):
    network = written(graph, "graphml")
    assert set(network.nodes) == {"B1", "B2", "B3"}
    edges = {(a, b, d["point"]) for a, b, d in network.edges(data=True)}
    assert edges == {("B1", "B2", "BP1"), ("B2", "B3", "VG1")}
    assert json.loads(network.nodes["B2"]["range"]) == [0.0, 1.0]


def test_mat_is_read_back_by_scipy(graph, written):
    data = written(graph, "mat")
    for label, branch in graph.branches.items():
        assert np.array_equal(data["branches"][label]["values"], branch.values)
        assert np.array_equal(np.ravel(data["branches"][label]["multipliers"]), np.ravel(branch.multipliers))
    assert data["special"]["VG1"]["kind"] == "velocity-graze"
    assert data["model"]["name"] == "pitchfork" and data["made"]["contvines"]
    assert [link["point"] for link in np.atleast_1d(data["switches"])] == [s.point for s in graph.switches]


def test_latex_has_a_row_per_branch_and_point(graph, written, tmp_path):
    text = written(graph, "latex")
    rows = [line.split(" & ")[0] for line in text.splitlines() if line.endswith(r"\\")]
    assert rows == ["branch", *graph.branches, "point", *graph.special]
    assert text.count(r"\begin{tabular}") == text.count(r"\end{tabular}") == 2
    assert "->" not in text and export(graph, None, tmp_path / "h.tex").exists()
    assert written(graph, "latex") == text  # a file that ends as its format is called is written again


def test_exports_of_a_file_carry_its_study_and_with_what_it_was_made(written, tmp_path):
    source = {"command": "atlas", "study": "a.toml", "text": "[atlas]\nseed = 7\n"}
    study = {"atlas": {"seed": 7}, "source": source}
    with Store.create(tmp_path / "g.vines", "one", study) as store:
        store.checkpoint(fakes.pitchfork_graph())
    graph = load(tmp_path / "g.vines", problems=False)
    data = written(graph, "json")
    assert data["study"] == study and data["made"]["core"]
    assert written(graph, "mat")["study"]["atlas"]["seed"] == 7
    assert "\n% seed = 7\n" in written(graph, "latex")
    assert json.loads(written(graph, "graphml").graph["study"]) == study
