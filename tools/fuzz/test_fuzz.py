"""A short search, and graphs with errors that every check must find; ``python -m tools.fuzz absorber 150 1`` runs a longer search."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber, Coupled
from tests.machines import ABSORBER
from tools.fuzz import finer, loci, neighbours, simulated, structure
from tools.fuzz.approached import comes_to, grow_without_bound
from tools.fuzz.drawing import draw
from tools.fuzz.many_digits import exact
from tools.fuzz.motion import alike, apart, shortest
from tools.fuzz.searching import search
from tools.fuzz.tally import Tally

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(("kind", "seed"), [("absorber", 0), ("absorber", 3), ("cavity", 8), ("coupled", 1)])
def test_a_short_search_finds_nothing(kind, seed):
    tally = search(kind, 1, seed)
    assert not tally.findings
    assert tally.counts["diagrams"] == 1
    assert tally.counts["orbits simulated"] > 0


def test_a_pair_that_passes_the_circle_next_to_the_doubling_from_which_it_comes_about():
    """A multiplier of a doubled orbit and one above +1 become a pair; simulations confirm that the orbits are unstable until the pair enters the circle."""
    assert not search("coupled", 112940, 325).findings


@pytest.mark.parametrize(("kind", "seed"), [("absorber", 23), ("coupled", 10)])
def test_diagrams_begun_on_loci_have_the_special_points(kind, seed):
    done = Counter()
    assert not loci.judge(kind, 553, seed, done)
    assert done["places"] > 1


def test_the_same_seed_draws_the_same_machine():
    one, other = (draw("absorber", 1, 3) for _ in range(2))
    assert one.machine == other.machine and one.options == other.options
    assert draw("absorber", 2, 3).machine != one.machine


@pytest.fixture(scope="module")
def graph():
    """Graph of LR with a fold, a symmetry breaking, and borders at which sticks and turns appear; LR continues beyond its border as virtual branch."""
    machine = ABSORBER
    orbit = machine.symmetric_orbit(amplitude=0.7)
    return cv.diagram(orbit, over="amplitude", within=(0.2, 0.92), depth=1, virtual=True)


def changed(graph, **branches):
    """Return the graph with some branches replaced."""
    return replace(graph, branches={**graph.branches, **branches})


def checks(judge, *given):
    """Return the names of the checks with findings."""
    tally = Tally()
    judge(*given, tally) if judge is not simulated.judge else judge(*given, tally, np.random.default_rng(1))
    return {finding.check for finding in tally.findings}


def word(graph, text, real=True):
    return next(
        b for b in graph if b.description["word"] == text and b.real == real and not b.problem.symmetric
    )


def test_nothing_is_found_in_the_graph_as_it_is(graph):
    for judge in (structure.judge, neighbours.judge, simulated.judge):
        assert not checks(judge, graph)


def test_stability(graph):
    branch = word(graph, "LR")
    forged = changed(graph, **{branch.label: replace(branch, stable=~branch.stable)})
    assert "stability" in checks(simulated.judge, forged)
    stable = branch.stable.copy()
    stable[len(stable) // 2 :] = False
    assert "stability" in checks(
        structure.judge, changed(graph, **{branch.label: replace(branch, stable=stable)})
    )


def test_virtual_branches_called_real_and_real_ones_called_virtual(graph):
    ghost, branch = word(graph, "LR", real=False), word(graph, "LR")
    forged = changed(graph, **{ghost.label: replace(ghost, real=True)})
    assert "margin" in checks(structure.judge, forged)
    assert "virtual" in checks(simulated.judge, forged)
    assert "virtual" in checks(simulated.judge, changed(graph, **{branch.label: replace(branch, real=False)}))


def test_doubled_branches_and_repeated_orbits(graph):
    branch = word(graph, "LR")
    plain = replace(graph, settings={**graph.settings, "virtual": False})
    assert "doubled" in checks(structure.judge, changed(plain, B99=replace(branch, label="B99")))
    twice = branch.orbit(3).repeat(2)
    problem = branch.problem.sibling(twice.word, twice.periods, False)
    points = np.array([problem.reduce(branch.orbit(i).repeat(2).nodes) for i in range(len(branch))])
    forged = replace(branch, problem=problem, points=points)
    assert "repeated" in checks(structure.judge, changed(graph, **{branch.label: forged}))


def test_a_branch_of_no_length(graph):
    branch = word(graph, "LR")
    kept = {
        name: getattr(branch, name)[[3, 3]]
        for name in ("points", "values", "tangents", "multipliers", "margin", "stable")
    }
    assert "no length" in checks(
        structure.judge, changed(graph, B99=replace(branch, label="B99", marks=(), **kept))
    )


def test_multipliers_at_borders(graph):
    branch = word(graph, "LRs")
    listed = branch.multipliers.copy()
    listed[[0, -1]] += 0.1
    assert "limit" in checks(
        neighbours.judge, changed(graph, **{branch.label: replace(branch, multipliers=listed)})
    )


def test_false_links(graph):
    switch = next(s for s in graph.switches if graph[s.target].description["word"] == "LRs")
    other = next(b for b in graph if b.label not in (switch.source, switch.target))
    forged = replace(graph, switches=[replace(switch, target=other.label)])
    assert "link" in checks(neighbours.judge, forged)
    branch = graph[switch.target]
    marks = tuple((len(branch) // 2 if label == switch.point else i, label) for i, label in branch.marks)
    assert "jump" in checks(neighbours.judge, changed(graph, **{branch.label: replace(branch, marks=marks)}))


def test_false_folds(graph):
    branch = word(graph, "LR")
    i = len(branch) // 2
    point = replace(
        graph.of_kind("fold")[0],
        label="LP99", branch=branch.label, index=i, value=float(branch.values[i]), u=branch.points[i],
        tangent=branch.tangents[i], problem=branch.problem,
    )  # fmt: skip
    marked = replace(branch, marks=(*branch.marks, (i, "LP99")))
    forged = replace(changed(graph, **{branch.label: marked}), special={**graph.special, "LP99": point})
    assert {"fold", "crossing"} <= checks(neighbours.judge, forged)


def test_points_that_are_lost(graph):
    fold = graph.of_kind("fold")[0]
    less = replace(graph, special={label: p for label, p in graph.special.items() if label != fold.label})
    tally = Tally()
    finer.compare(less, graph, graph.within, "itself", tally)
    assert not tally.findings
    finer.compare(graph, less, graph.within, "less", tally)
    assert [finding.check for finding in tally.findings] == ["lacks"]


def test_multipliers_of_no_simulation(graph):
    branch = word(graph, "LR")
    orbit = branch.orbit(len(branch) // 2)
    forged = orbit.with_multipliers(orbit.multipliers + 0.01)
    tally = Tally()
    simulated.follow(forged, "B99", True, tally)
    assert [finding.check for finding in tally.findings] == ["multipliers"]


def test_motions(graph):
    """A motion shifted by a forcing period, or repeated twice, is the same; shifted by half a period it is not."""
    orbit = word(graph, "LR").orbit(5)
    assert apart(orbit, orbit.repeat(3).rotate(2)) < 1e-12
    assert apart(orbit, orbit.mirror()) < 1e-12 < 1e-2 < apart(orbit, orbit.mirror(), images=False)
    assert (shortest(orbit), shortest(orbit.repeat(4))) == (1, 1)
    assert alike(np.array([0.5, -0.2]), np.array([-0.2, 0.5])) < 1e-15


@pytest.mark.parametrize(
    ("kind", "salt", "seed", "counted"),
    [
        (
            "absorber",
            404,
            493,
            "folds at which the parameter turns",
        ),  # a period doubling 5e-15 beside the fold
        ("absorber", 404, 132, "multipliers against many digits"),  # 3e7 times as steep as the parameter
        ("cavity", 404, 373, "stable stretches narrower than floating point resolves"),
    ],
)
def test_true_results_at_the_edge_of_floating_point(kind, salt, seed, counted):
    tally = search(kind, salt, seed)
    assert not tally.findings
    assert tally.counts[counted] > 0


def test_orbits_in_many_digits():
    """The product of multipliers is r^4 (MODEL, section 3), and the fold of LR lies at its closed form (section 4)."""
    r, h = 0.76, 0.5 * np.pi * 1.006 * 0.5 * 0.211
    machine = Absorber(restitution=r, friction=0.5, gravity=0.211, mass_ratio=0.006)
    found = exact(machine.symmetric_orbit(amplitude=0.6))
    assert abs(found.shift) < 1e-15 and found.moved < 1e-14
    assert np.prod(found.multipliers) == pytest.approx(r**4, rel=1e-14)
    lost = (1 - r) / (1 + r)
    beta = (2 * np.pi - 4 * lost * h) / (np.pi**2 + 4 * lost**2)
    fold = np.sqrt((1 - 0.5 * np.pi * beta) ** 2 + (lost * beta + h) ** 2)
    beside = exact(machine.symmetric_orbit(amplitude=fold + 1e-13))
    assert np.abs(beside.multipliers - 1.0).min() < 1e-5  # a square root
    assert beside.steepness > 1e5
    moved = machine.symmetric_orbit(amplitude=0.6)
    moved = type(moved)(moved.model, moved.word, 1, moved.nodes * (1 + 1e-6), moved.params)
    assert abs(exact(moved).shift) + exact(moved).moved > 1e-8


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_orbits_of_the_coupled_machine_in_many_digits(friction):
    """Liouville: between events areas shrink with exp(-c t), at impacts by r^2 (the absorber's two dimensions)."""
    machine = Coupled(
        restitution=0.76, mass_ratio=0.006, forcing=2.47, damping=0.9, friction=friction, gravity=0.211
    )
    orbit = machine.symmetric_orbit(frequency=1.01)
    found = exact(orbit)
    period = 2 * np.pi / 1.01
    shrunk = machine.restitution**4 * np.exp(-machine.mass_ratio * machine.damping * period)
    assert np.prod(found.multipliers) == pytest.approx(shrunk, rel=1e-13)
    assert alike(found.multipliers, orbit.multipliers) < 1e-10


def test_multipliers_are_not_believed_for_want_of_digits(graph):
    branch = word(graph, "LR")
    orbit = branch.orbit(len(branch) // 2)
    assert simulated.in_many_digits(orbit)
    assert not simulated.in_many_digits(orbit.with_multipliers(orbit.multipliers * (1 + 1e-4)))


def test_multipliers_that_do_not_grow_are_not_called_unbounded(graph):
    """Near the fold of LR multipliers tend to 1; at regular points they tend to those of the point."""
    branch = word(graph, "LR")
    orbits = [branch.orbit(i) for i in (2, 3)]
    assert not grow_without_bound(*orbits, 0.0)
    assert not grow_without_bound(*orbits[::-1], 0.0)


def test_a_branch_comes_to_its_own_points_in_many_digits_and_to_no_others(graph):
    branch = word(graph, "LRs")
    orbits = [branch.orbit(i) for i in (4, 3)]
    assert comes_to(*orbits, branch.orbit(1))
    moved = branch.orbit(1)
    moved = type(moved)(moved.model, moved.word, moved.periods, moved.nodes * (1.0 + 1e-6), moved.params)
    assert not comes_to(*orbits, moved)
    assert not comes_to(*orbits[::-1], branch.orbit(1))
