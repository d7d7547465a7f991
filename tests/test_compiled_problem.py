"""The documented compiled problem: C functions, followed by the native continuation loop."""

import json
import runpy
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from contvines.core.library import library
from tools.demos.make_table import TABLE

lacking = shutil.which("cc") is None or library() is None
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(lacking, reason="no C compiler, or no native core"),
]
EXAMPLES = Path(__file__).parents[1] / "examples" / "compiled"


def example_of(name):
    """The names of an example."""
    return SimpleNamespace(**runpy.run_path(str(EXAMPLES / f"{name}.py")))


@pytest.mark.parametrize("in_native", [True, False])
def test_a_table_of_c_functions_is_followed(tmp_path, monkeypatch, in_native):
    """Against the solves in thirty digits of the same equations (folds with a singular Jacobian, Hopf with zero trace); without the native core, too."""
    monkeypatch.setattr("contvines.continuation.engine.native", lambda: in_native)
    example = example_of("reaction")
    graph = cv.diagram(example.Reaction(example.compiled(tmp_path)), within=(0.0, 0.15))
    expected = sorted((row["kind"], row["value"]) for row in json.loads(TABLE.read_text())["ab"])
    found = sorted((p.kind, p.value) for p in graph.special.values() if p.kind != "end")
    assert [kind for kind, _ in found] == [kind for kind, _ in expected]
    assert [value for _, value in found] == pytest.approx([value for _, value in expected], abs=1e-12)


def test_a_compiled_right_hand_side_gives_what_python_gives(tmp_path):
    example = example_of("lorenz")
    flow = example.flow(example.compiled(tmp_path))
    graph = cv.diagram(flow, over="r", within=(13.0, 26.0), settings={"max_branches": 2})
    assert graph.of_kind("hopf")[0].value == pytest.approx(470 / 19, abs=1e-11)
    assert graph.of_kind("homoclinic")[0].value == pytest.approx(13.926557, abs=1e-6)  # Sparrow 1982: 13.926
    rng = np.random.default_rng(1)
    x = rng.uniform(-1.0, 1.0, (4, 3))
    field, (r, s, b) = flow.field, (20.0, 10.0, 8 / 3)
    expected = np.array([[s * (v - u), r * u - v - u * w, u * v - b * w] for u, v, w in x])
    assert np.allclose(field(x, 20.0), expected, rtol=1e-15)
    for j in range(3):
        step = np.eye(3)[j] * 1e-5
        difference = (field(x + step, 20.0) - field(x - step, 20.0)) / 2e-5
        assert np.allclose(field.jacobian(x, 20.0)[:, :, j], difference, atol=1e-9)
    assert np.allclose(field.slope(x, 20.0), np.column_stack([0 * x[:, 0], x[:, 0], 0 * x[:, 0]]))


def test_problems_over_several_parameters_share_a_workspace(tmp_path):
    """As along loci: x' = s (y - x) alone has s, y' alone has r; residuals are linear in both."""
    example = example_of("lorenz")
    orbit = example.flow(example.compiled(tmp_path)).attractor([1.0, 1.0, 1.0], r=160.0)
    work = orbit.problem("r").workspace()
    for name, value, row in (("r", 160.0, 1), ("s", 10.0, 0)):
        problem, ends = orbit.problem(name), []
        for p in (value - 0.5, value + 0.5, value):
            problem.evaluate(orbit.u, p, work)
            ends.append(work.residual.copy())
        assert np.allclose(work.derivative, ends[1] - ends[0], rtol=0.0, atol=1e-10)
        by_state = np.abs(work.derivative[: problem.states]).reshape(-1, 3).max(axis=0)
        assert (by_state > 0.1).tolist() == [row == 0, row == 1, False]
