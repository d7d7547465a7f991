"""Branches that end where the user says so."""

import pytest

import contvines as cv
from contvines.journal import MemoryJournal


def parabola(within=(-1.0, 9.0), **options):
    """p = u^2 from u = 1 on."""
    problem = cv.AlgebraicProblem(
        lambda u, p: p - u**2, [1.0], 1.0, outputs={"square": lambda u, p: u[0] ** 2}, scale=1.0
    )
    return cv.diagram(problem, within=within, **options)


def test_a_function_stops_a_branch_at_its_zero():
    graph = parabola((-1.0, 4.0), stop={"half": lambda u, p: u[0] - 0.5})
    (branch,) = graph
    assert branch.points.min() == pytest.approx(0.5, abs=1e-14) and branch.range == pytest.approx((0.25, 4.0))
    assert not graph.of_kind("fold")
    assert "stops at US1 (half), p = 0.25" in branch.ended
    graph = parabola((-1.0, 4.0), stop={"measured": ("square", 2.25)})
    assert graph["B1"].points.max() == pytest.approx(1.5, abs=1e-14)


def test_bounds_of_measures():
    graph = parabola(bounds={"u0": (-1.0, 2.0)})
    assert (graph["B1"].points.min(), graph["B1"].points.max()) == pytest.approx((-1.0, 2.0), abs=1e-14)
    assert graph.of_kind("fold")[0].value == pytest.approx(0.0, abs=1e-15)
    assert len(parabola(bounds={"u0": (None, 2.0)}).of_kind("user")) == 1
    for bounds, said in (
        ({"u0": (2.0, 3.0)}, r"at the start u0 = 1 is outside of its bounds \[2, 3\]"),
        ({"u7": (2.0, 3.0)}, "no measure 'u7'"),
        ({"u0": 3.0}, "two numbers"),
        ({"u0": (3.0, 2.0)}, "the smaller one"),
    ):
        with pytest.raises(ValueError, match=said):
            parabola(bounds=bounds)


def test_a_branch_that_creeps_ends_and_says_so():
    graph = parabola((-1.0, 2.0), settings={"max_step": 5e-7, "first_step": 1e-7})
    assert all("creeps near p = " in said for said in graph["B1"].ended)
    assert 600 <= len(graph["B1"]) < 4000


# a transcritical point at p = 0, and the branch u = p that leaves there
TREE = cv.AlgebraicProblem(lambda u, p: u * (p - u), [0.0], -1.0)


class Cut(MemoryJournal):
    """Is interrupted after so many records, as a run that is killed."""

    left = 3

    def record(self, key, values):
        super().record(key, values)
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


def test_limits_on_resume(tmp_path):
    """Bounds and stops hold in a run that goes on after an interrupt, and in what is kept of it."""

    def run(journal=None):
        return cv.diagram(
            TREE, within=(-1.0, 1.0), journal=journal,
            bounds={"u0": (-0.5, None)}, stop={"far": lambda u, p: u[0] - 0.75},
        )  # fmt: skip

    whole, journal = run(), Cut()
    with pytest.raises(KeyboardInterrupt):
        run(journal)
    graph = run(journal)
    assert str(graph) == str(whole)
    assert sorted(point.value for point in graph.of_kind("user")) == pytest.approx([-0.5, 0.75])
    graph.save(tmp_path / "tree.vines")
    again = cv.load(tmp_path / "tree.vines")
    assert str(again) == str(whole) and again.settings["bounds"] == {"u0": [-0.5, None]}


def test_points_at_the_very_end_of_the_interval():
    """A branch point, a fold, and none of them a little inside."""
    assert "at the end" in str(cv.diagram(TREE, within=(-1.0, 0.0)))
    assert "at the end" not in str(cv.diagram(TREE, within=(-1.0, 1e-3)))
    fold = str(parabola((0.0, 2.0)))
    assert "fold" in fold and "at the end" in fold
