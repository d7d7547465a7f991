"""`contvines prove`: theorems from the command line, kept, checked again, and refused when tampered with."""

import json
import shutil
import sys

import pytest

import contvines as cv
from contvines.report.contents import contents
from tests.contvines.studies import EXAMPLES
from tests.machines import absorber_graph

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    path = tmp_path_factory.mktemp("prove") / "a.vines"
    absorber_graph(0.6, (0.4, 0.75), depth=0).save(path)
    return path


@pytest.fixture
def kept(made, run, tmp_path):
    """A graph in the folder in which commands run."""
    shutil.copy(made, tmp_path / "a.vines")


def test_a_study(run):
    proof = run.json(f"prove {EXAMPLES}/friction.toml")
    assert (proof["existence"], proof["real"], proof["stable"]) == (True, True, True)
    assert 0 < proof["radius"] < 1e-20
    assert [[len(pair) for pair in node] for node in proof["nodes"]] == [[2, 2], [2, 2]]
    assert all(isinstance(text, str) for node in proof["nodes"] for pair in node for text in pair)


def test_a_file_its_labels_and_its_certificates(kept, run, tmp_path):
    proofs, graph = run.json("prove a.vines"), cv.load("a.vines")
    assert set(proofs) == set(graph.special) == set(graph.proofs)
    assert all(proof["existence"] for proof in proofs.values())
    assert abs(float(proofs["SB1"]["value"][0]) ** 2 - 0.5282903) < 5e-8
    assert "proved" in str(graph)
    assert "exists" in run.ok("prove a.vines B1:5 -o c.json")
    assert run.ok("prove a.vines --check").count("verified") == len(graph.special) + 1
    certificate = json.loads((tmp_path / "c.json").read_text())
    claims = certificate["B1:5"]["claims"]
    claims["stable"] = not claims["stable"]
    for boxes in (
        [],
        [{}] * 5001,
    ):  # so long that checking is announced; the first box is none, so it ends at once
        if boxes:
            certificate["B1:5"]["boxes"] = boxes
        (tmp_path / "c.json").write_text(json.dumps(certificate))
        status, out, err = run("prove c.json --check")
        assert status == 1 and "NOT verified" in out and ("5001 boxes" in err) == bool(boxes)


def test_a_problem_of_ones_own_has_no_proofs(run):
    problem = cv.AlgebraicProblem(lambda u, p: [p - u[0] ** 2], [1.0], 1.0)
    cv.diagram(problem, within=(-1.0, 2.0)).save("own.vines")
    status, _, err = run("prove own.vines")
    assert status == 1 and "offers no proofs" in err


@pytest.mark.parametrize(("package", "line"), [("flint", "a.vines"), ("mpmath", "papers.json --check")])
def test_without_the_extra_a_sentence_names_it(package, line, kept, tmp_path, run, monkeypatch):
    (tmp_path / "papers.json").write_text('{"start": {}}')
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.delitem(sys.modules, "orbits.proofs.checker", raising=False)
    status, _, err = run(f"prove {line}")
    assert status == 1 and '[proofs]"' in err


def test_what_is_proved_is_marked_in_tables_pictures_and_the_report(kept, run):
    graph, plain = cv.load("a.vines"), cv.load("a.vines")
    proof = graph.prove("B1", within=(0.55, 0.57))["B1"]
    assert all(piece.existence for piece in proof.pieces)
    graph.prove("SB1")
    shown = str(graph)
    assert "0.55..0.57 real, stable" in shown
    assert "proved" not in str(plain).splitlines()[2]
    marked, unmarked = (one.plot(labels=False).axes[0] for one in (graph, plain))
    for axes in (marked, unmarked):
        names = [text.get_text() for text in axes.get_legend().get_texts()]
        assert ("proved" in names) == (axes is marked)
    # a band per stretch and a mark per proved point lie beneath the same picture
    assert len(marked.lines) == len(unmarked.lines) + len(proof.pieces) + 1
    graph.save("marked.vines")
    assert str(cv.load("marked.vines")) == shown
    assert "verified" in run.ok("prove marked.vines B1 --check")
    told = contents(graph, "marked.vines")
    assert [branch["proof"] for branch in told["branches"]] == ["0.55..0.57 real, stable"]
    assert next(point for point in told["special"] if point["label"] == "SB1")["proof"] == "proved"
