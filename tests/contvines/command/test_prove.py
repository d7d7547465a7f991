"""`contvines prove`: theorems from the command line, kept, checked again, and refused when tampered with."""

import json
import sys
from pathlib import Path

import pytest

import contvines as cv
from contvines.report.contents import contents
from tests.machines import ABSORBER

pytestmark = pytest.mark.slow

STUDY = Path(__file__).parents[3] / "examples" / "friction.toml"


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    path = tmp_path_factory.mktemp("prove") / "a.vines"
    absorber = ABSORBER
    graph = cv.diagram(absorber.symmetric_orbit(amplitude=0.6), over="amplitude", within=(0.4, 0.75), depth=0)
    graph.save(path)
    return path


def test_a_study(run):
    status, out, _ = run("prove", STUDY, "--json")
    proof = json.loads(out)
    assert status == 0
    assert (proof["existence"], proof["real"], proof["stable"]) == (True, True, True)
    assert 0 < proof["radius"] < 1e-20
    assert [[len(pair) for pair in node] for node in proof["nodes"]] == [[2, 2], [2, 2]]
    assert all(isinstance(text, str) for node in proof["nodes"] for pair in node for text in pair)


def test_a_file_its_labels_and_its_certificates(kept, run, tmp_path):
    status, out, _ = run("prove", kept, "--json")
    proofs = json.loads(out)
    graph = cv.load(kept)
    assert status == 0 and set(proofs) == set(graph.special) == set(graph.proofs)
    assert all(proof["existence"] for proof in proofs.values())
    assert abs(float(proofs["SB1"]["value"][0]) ** 2 - 0.5282903) < 5e-8
    assert "proved" in str(graph)
    status, out, _ = run("prove", kept, "B1:5", "-o", tmp_path / "c.json")
    assert status == 0 and "exists" in out
    status, out, _ = run("prove", kept, "--check")
    assert status == 0 and out.count("verified") == len(graph.special) + 1
    made = json.loads((tmp_path / "c.json").read_text())
    made["B1:5"]["claims"]["stable"] = not made["B1:5"]["claims"]["stable"]
    (tmp_path / "c.json").write_text(json.dumps(made))
    status, out, _ = run("prove", tmp_path / "c.json", "--check")
    assert status == 1 and "NOT verified" in out
    made["B1:5"]["boxes"] = [
        {}
    ] * 5001  # so long that checking is announced; the first box is none, so it ends at once
    (tmp_path / "c.json").write_text(json.dumps(made))
    status, out, err = run("prove", tmp_path / "c.json", "--check")
    assert status == 1 and "NOT verified" in out and "5001 boxes" in err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["XX"], "no label"),
        (["B1:9999"], "numbered from 0"),
        (["SB1:1"], "single point"),
        (["SB1", "--within", "0.5", "0.6"], "for branches"),
        (["B1", "--within", "0.6", "0.5"], "give the lower value first"),
    ],
)
def test_what_cannot_be_proved_is_refused_in_a_sentence(kept, run, words, says):
    status, _, err = run("prove", kept, *words)
    assert status == 1 and says in err and "Traceback" not in err


def test_a_problem_of_ones_own_has_no_proofs(tmp_path, run):
    problem = cv.AlgebraicProblem(lambda u, p: [p - u[0] ** 2], [1.0], 1.0)
    path = tmp_path / "own.vines"
    cv.diagram(problem, within=(-1.0, 2.0)).save(path)
    status, _, err = run("prove", path)
    assert status == 1 and "offers no proofs" in err


def test_a_page_has_no_closed_form_to_prove(run):
    page = STUDY.parent / "machines" / "impact_oscillator.toml"
    status, _, err = run("prove", page)
    assert status == 1 and "offers no proofs" in err and "should not" not in err


@pytest.mark.parametrize(("package", "words"), [("flint", [STUDY]), ("mpmath", [None, "--check"])])
def test_without_the_extra_a_sentence_names_it(package, words, tmp_path, run, monkeypatch):
    papers = tmp_path / "papers.json"
    papers.write_text('{"start": {}}')
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.delitem(sys.modules, "orbits.proofs.checker", raising=False)
    status, _, err = run("prove", *(papers if word is None else word for word in words))
    assert status == 1 and '[proofs]"' in err


def test_what_is_proved_is_marked_in_tables_pictures_and_the_report(kept, run, tmp_path):
    graph = cv.load(kept)
    plain = cv.load(kept)
    plain.proofs.clear()
    graph.proofs.clear()
    proof = graph.prove("B1", within=(0.55, 0.57))["B1"]
    assert all(piece.existence for piece in proof.pieces)
    graph.prove("SB1")
    shown = str(graph)
    assert "0.55..0.57 real, stable" in shown
    assert "proved" not in str(plain).splitlines()[2]
    marked, unmarked = graph.plot(labels=False), plain.plot(labels=False)
    names = [text.get_text() for text in marked.axes[0].get_legend().get_texts()]
    assert "proved" in names
    assert "proved" not in [text.get_text() for text in unmarked.axes[0].get_legend().get_texts()]
    # a band per stretch and a mark per proved point lie beneath the same picture
    assert len(marked.axes[0].lines) == len(unmarked.axes[0].lines) + len(proof.pieces) + 1
    path = tmp_path / "marked.vines"
    graph.save(path)
    assert str(cv.load(path)) == shown
    status, out, _ = run("prove", path, "B1", "--check")
    assert status == 0 and "verified" in out
    told = contents(graph, "marked.vines")
    assert [branch["proof"] for branch in told["branches"]] == ["0.55..0.57 real, stable"]
    assert next(point for point in told["special"] if point["label"] == "SB1")["proof"] == "proved"
