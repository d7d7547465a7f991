"""The documented compiled problem: C functions, followed by the native continuation loop."""

import importlib.util
import json
import shutil
from pathlib import Path

import pytest

import contvines as cv
from contvines.core.library import library

ROOT = Path(__file__).parents[1]
needed = pytest.mark.skipif(
    shutil.which("cc") is None or library() is None, reason="no C compiler, or no native core"
)


@needed
def test_a_table_of_c_functions_is_followed(tmp_path):
    """Against the solves in thirty digits of the same equations (folds with a singular Jacobian, Hopf with zero trace)."""
    path = ROOT / "examples" / "compiled" / "reaction.py"
    spec = importlib.util.spec_from_file_location("reaction", path)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    graph = cv.diagram(example.Reaction(example.compiled(tmp_path)), within=(0.0, 0.15))
    table = ROOT / "tests" / "contvines" / "problems" / "demos" / "table.json"
    expected = sorted((row["kind"], row["value"]) for row in json.loads(table.read_text())["ab"])
    found = sorted((p.kind, p.value) for p in graph.special.values() if p.kind != "end")
    assert [kind for kind, _ in found] == [kind for kind, _ in expected]
    assert [value for _, value in found] == pytest.approx([value for _, value in expected], abs=1e-12)
