"""Where both ends of a stretch do not agree with what is found between, the graph says so, with what is certain on both sides."""

import json

import pytest

import contvines as cv


def jumping(before, after):
    """The fixed point u = p of a map whose multiplier jumps at p = 0.3."""
    problem = cv.MapProblem(lambda u, p: [p + (before if p < 0.3 else after) * (u[0] - p)], u0=[0.1], p0=0.1)
    return cv.diagram(problem, within=(0.0, 1.0), depth=0)


@pytest.mark.parametrize(
    ("before", "after", "counts"),
    [(-0.5, -1.5, ((0, 0, 0), (0, 1, 0))), (-1.7, -0.2, ((0, 1, 0), (0, 0, 0)))],
)
def test_a_multiplier_that_jumps_over_the_circle_is_no_special_point(before, after, counts):
    graph = jumping(before, after)
    assert {point.kind for point in graph.special.values()} == {"end"}
    (found,) = graph.unresolved
    assert found.branch == "B1" and found.reason == "multipliers"
    assert found.low <= 0.3 <= found.high and found.high - found.low < 1e-6
    numbers = (found.before, found.after)
    assert numbers == counts or numbers == counts[::-1]
    stable = [(0.0, 0.3)] if abs(before) < 1.0 else [(0.3, 1.0)]
    assert graph["B1"].stable_intervals() == [pytest.approx(stable[0], abs=1e-6)]


@pytest.mark.slow
def test_it_is_in_tables_files_and_pictures(tmp_path):
    graph = jumping(-0.5, -1.5)
    assert "unresolved on B1 at p = 0.3" in str(graph)
    (entry,) = json.loads(json.dumps(graph.to_dict()))["unresolved"]
    assert entry["branch"] == "B1" and entry["low"] <= 0.3 <= entry["high"]
    cv.save(graph, tmp_path / "jump.vines")
    assert cv.load(tmp_path / "jump.vines").unresolved == graph.unresolved
    legend = graph.plot().axes[0].get_legend()
    assert "unresolved" in [text.get_text() for text in legend.get_texts()]


def test_points_that_are_told_apart_are_not_unresolved():
    """Two multipliers -(1 + p) and -(1 + p - 1e-6) pass -1 at 0 and 1e-6."""
    problem = cv.MapProblem(
        lambda u, p: [-(1 + p) * u[0] + u[0] ** 3, -(1 + p - 1e-6) * u[1] + u[1] ** 3], u0=[0.0, 0.0], p0=-0.5
    )
    graph = cv.diagram(problem, within=(-0.6, 0.5), depth=0)
    assert [p.value for p in graph.of_kind("period-doubling")] == pytest.approx([0.0, 1e-6], abs=1e-11)
    assert not graph.unresolved
