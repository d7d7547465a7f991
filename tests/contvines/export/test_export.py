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


def test_csv_has_every_point_at_full_precision(graph, tmp_path):
    path = export(graph, "csv", tmp_path / "g.csv")
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == sum(len(b) for b in graph.branches.values())
    for branch in graph.branches.values():
        mine = [r for r in rows if r["branch"] == branch.label]
        assert [float(r["p"]) for r in mine] == branch.values.tolist()
        assert [float(r["u0"]) for r in mine] == branch.points[:, 0].tolist()
        assert [r["stable"] == "1" for r in mine] == branch.stable.tolist()
        assert [
            complex(float(r["multiplier0_re"]), float(r["multiplier0_im"])) for r in mine
        ] == branch.multipliers[:, 0].tolist()
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


def test_csv_and_mat_have_word_periods_and_measures(graph, tmp_path):
    branch = graph.branches["B2"]  # the parabola p = u^2
    branch.problem = Measured()
    branch.description = {"word": "LR", "periods": 3}
    with export(graph, "csv", tmp_path / "g.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
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
    data = loadmat(export(graph, "mat", tmp_path / "g.mat"), simplify_cells=True)["branches"]
    assert (data["B2"]["word"], data["B2"]["periods"]) == ("LR", 3)
    x = np.linspace(0, 1, 31)
    assert np.array_equal(data["B2"]["measures"]["double"], 2 * x)
    assert np.isnan(data["B2"]["measures"]["triple"]).sum() == np.sum(x**2 > 0.5)


def test_json_is_the_graphs_own_object_in_standard_json(graph, tmp_path):
    graph.special["BP1"].bracket = (float("nan"), float("inf"))
    text = export(graph, "json", tmp_path / "g.json").read_text()
    assert "NaN" not in text and "Infinity" not in text
    data = json.loads(text)
    assert [b["label"] for b in data["branches"]] == ["B1", "B2", "B3"]
    assert data["special"][0]["value"] == {"p": 0.0}
    assert data["special"][0]["bracket"] == [None, None]
    assert data["switches"][0]["from"] == "B1"


def test_graphml_is_read_back_by_networkx(graph, tmp_path):
    network = networkx.read_graphml(export(graph, "graphml", tmp_path / "g.graphml"), force_multigraph=True)
    assert set(network.nodes) == {"B1", "B2", "B3"}
    assert {(a, b, d["point"]) for a, b, d in network.edges(data=True)} == {
        ("B1", "B2", "BP1"),
        ("B2", "B3", "VG1"),
    }
    assert json.loads(network.nodes["B2"]["range"]) == [0.0, 1.0]


def test_mat_is_read_back_by_scipy(graph, tmp_path):
    data = loadmat(export(graph, "mat", tmp_path / "g.mat"), simplify_cells=True)
    for label, branch in graph.branches.items():
        assert np.array_equal(data["branches"][label]["values"], branch.values)
        assert np.array_equal(np.ravel(data["branches"][label]["multipliers"]), np.ravel(branch.multipliers))
    assert data["special"]["VG1"]["kind"] == "velocity-graze"
    assert data["model"]["name"] == "pitchfork" and data["made"]["contvines"]
    assert [link["point"] for link in np.atleast_1d(data["switches"])] == [s.point for s in graph.switches]


def test_latex_has_a_row_per_branch_and_point(graph, tmp_path):
    place = export(graph, "latex", tmp_path / "g.tex")
    text = place.read_text()
    rows = [line.split(" & ")[0] for line in text.splitlines() if line.endswith(r"\\")]
    assert rows == ["branch", *graph.branches, "point", *graph.special]
    assert text.count(r"\begin{tabular}") == text.count(r"\end{tabular}") == 2
    assert "->" not in text and export(graph, None, tmp_path / "h.tex").exists()


def test_what_cannot_be_written_has_its_sentence(graph, tmp_path):
    with pytest.raises(
        ValueError, match="--to xml: there is no such format; choose one of csv, json, graphml, mat"
    ):
        export(graph, "xml", tmp_path / "g.xml")
    with pytest.raises(ValueError, match="there is no folder"):
        export(graph, "csv", tmp_path / "none" / "g.csv")
    with pytest.raises(ValueError, match="cannot be written"):
        export(graph, "json", tmp_path)


def test_exports_of_a_file_carry_its_study_and_with_what_it_was_made(tmp_path):
    study = {
        "atlas": {"seed": 7},
        "source": {"command": "atlas", "study": "a.toml", "text": "[atlas]\nseed = 7\n"},
    }
    with Store.create(tmp_path / "g.vines", "one", study) as store:
        store.checkpoint(fakes.pitchfork_graph())
    graph = load(tmp_path / "g.vines", problems=False)
    data = json.loads(export(graph, "json", tmp_path / "g.json").read_text())
    assert data["study"] == study and data["made"]["core"]
    assert (
        loadmat(export(graph, "mat", tmp_path / "g.mat"), simplify_cells=True)["study"]["atlas"]["seed"] == 7
    )
    assert "\n% seed = 7\n" in export(graph, "latex", tmp_path / "g.tex").read_text()
    network = networkx.read_graphml(export(graph, "graphml", tmp_path / "g.graphml"), force_multigraph=True)
    assert json.loads(network.graph["study"]) == study


def test_a_file_that_ends_as_its_format_is_called_is_written_again(graph, tmp_path):
    for _ in range(2):
        assert export(graph, "latex", tmp_path / "table.latex").exists()
