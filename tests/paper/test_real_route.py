"""The real route of the paper's set against a brute-force return map of 40 digits that knows nothing of
the package.

Machine: r = 0.76, mu = 0.5, g = 0.211, eps = 0.006, Omega = 1. The values of C^2 below are roots found by
`brute`: the motion is integrated event by event, the orbit is a fixed point of the return map, its
multipliers are those of central differences, and the parameter is moved by the secant rule until the
border's own condition holds.
"""

import numpy as np
import pytest
from mpmath import eye, mp, mpf

import contvines as cv
from orbits import Absorber
from tests.machines import ABSORBER
from tests.paper.brute import Machine, eigenvalues, secant

pytestmark = pytest.mark.slow

H = mpf("1.006") * mpf("0.5") * mpf("0.211") * mp.pi / 2

BREAKING = "0.5282903125517541"  # symmetric LR, half map's multiplier -1
GRAZE = "0.7322667847680374"  # asymmetric LR, w' touches 0 in the long flight
STICK_TURN = "0.7489568973481195"  # the stick's reserve a - |v''| is used up: a turn comes before it
TWO_TURNS = "0.7982897117006584"  # the second zero of w' is a turn as well
DOUBLING = "1.1282649657742850"  # LRtt, multiplier -1


def det_plus(A):
    """det(A + I): zero where a multiplier is -1."""
    M = A + eye(2)
    return M[0, 0] * M[1, 1] - M[0, 1] * M[1, 0]


@pytest.fixture(scope="module")
def graph():
    return cv.diagram(
        ABSORBER.symmetric_orbit(amplitude=0.55), over="amplitude", within=(0.17, 1.27), depth=3
    )


def route(graph):
    """Branches and points met from the symmetry breaking to the period-4-impact orbits, by the switches
    alone."""
    by_point = {}
    for switch in graph.switches:
        by_point.setdefault(switch.point, []).append(switch)
    start = next(p for p in graph.special.values() if p.kind == "symmetry-breaking")
    steps = [(start, graph[by_point[start.label][0].target])]
    while steps[-1][0].kind != "period-doubling":
        here = steps[-1][1]
        onwards = [
            p for p in graph.special.values()
            if p.branch == here.label and p.kind in ("velocity-graze", "stick", "period-doubling")
        ]  # fmt: skip
        assert len(onwards) == 1
        steps.append((onwards[0], graph[by_point[onwards[0].label][0].target]))
    return steps


def left_start(orbit):
    """(psi, B+) just after the impact on the left wall that opens the word, and the letters that follow."""
    turned = orbit.rotate(orbit.word.events.index("L"))
    text = turned.word.text
    return turned.nodes[0], text[1:] + text[0]


def guess_near(branch, squared):
    """The nodes of the branch's point nearest to C^2: only a starting guess for the brute-force Newton."""
    i = int(np.argmin(np.abs(branch.values**2 - float(squared))))
    return left_start(branch.orbit(i))


def brute_orbit(branch, squared, script=None, half=False):
    """Brute-force machine, word and fixed point near a branch."""
    machine = Machine(squared)
    guess, letters = guess_near(branch, squared)
    word = {"letters": letters, "script": script}
    return machine, word, machine.orbit(guess, word, half=half)


def seen_on(branch, squared, script=None):
    """What one period of the fixed point shows, its zeros of w' read as the script says."""
    machine, word, node = brute_orbit(branch, squared, script)
    letters, _, seen = machine.go((node[0], node[1]), len(word["letters"]), script)
    return letters, seen


def simulated(branch, squared, script):
    """The same fixed point, simulated without a script: mechanics decides what happens, and it closes again."""
    machine, word, node = brute_orbit(branch, squared, script)
    letters, end, seen = machine.go((node[0], node[1]), len(word["letters"]))
    assert abs(end[0] - node[0] - 2 * mp.pi) < 1e-30
    assert abs(end[1] - node[1]) < 1e-30
    return letters, seen


def test_the_diagram_walks_the_real_route(graph):
    steps = route(graph)
    words = [branch.description["word"] for _, branch in steps]
    assert [sorted(word) for word in words] == [sorted(w) for w in ("LR", "LRs", "LRts", "LRtt", "LRttLRtt")]
    assert [branch.description["periods"] for _, branch in steps] == [1, 1, 1, 1, 2]
    assert [branch.description["impacts"] for _, branch in steps][-1] == 4
    assert all(point.real and branch.real for point, branch in steps)
    assert [point.kind for point, _ in steps] == [
        "symmetry-breaking", "velocity-graze", "stick", "stick", "period-doubling",
    ]  # fmt: skip
    told = [float(value) for value in (BREAKING, GRAZE, STICK_TURN, TWO_TURNS, DOUBLING)]
    for (point, _), value in zip(steps, told, strict=True):
        assert point.value**2 == pytest.approx(value, abs=1e-10)
        assert point.replay is not None and point.replay < 1e-9
        assert point.residual < 1e-12


def test_breaking_by_brute_force(graph):
    """det(M + I) = 0 for the half map M; the closed form of the paper agrees."""
    branch = graph["B1"]

    def defect(squared):
        machine, word, node = brute_orbit(branch, squared, half=True)
        return det_plus(machine.derivative(node, word, half=True))

    found = secant(defect, "0.5282", "0.5284")
    loss = (1 - mpf("0.76")) / (1 + mpf("0.76"))
    beta = (2 * mp.pi - 4 * loss * H) / (mp.pi**2 - 4)
    assert abs(found - ((1 - mp.pi * beta / 2) ** 2 + (loss * beta + H) ** 2)) < 1e-15
    assert abs(found - mpf(BREAKING)) < 1e-14
    beside = [brute_orbit(branch, mpf(BREAKING) + side, half=True) for side in (mpf("-1e-9"), mpf("1e-9"))]
    below, above = (eigenvalues(m.derivative(x, w, half=True)) for m, w, x in beside)
    assert min(z.real for z in below) > -1.0 > min(z.real for z in above)


def test_graze_by_brute_force(graph):
    """The smallest speed in the long flight, friction's sign held, reaches 0; then the motion itself
    sticks."""
    branch = route(graph)[0][1]

    def defect(squared):
        return min(seen_on(branch, squared, script="x")[1]["lowest"])

    found = secant(defect, "0.7321", "0.7322")
    assert abs(found - mpf(GRAZE)) < 1e-14
    assert simulated(branch, found - mpf("1e-9"), "x")[0] == "RL"
    letters, seen = simulated(route(graph)[1][1], found + mpf("1e-9"), "s")
    assert sorted(letters) == sorted("RLs")
    assert 0 < seen["held"][0] < 1e-3


def test_turn_before_the_stick_by_brute_force(graph):
    """The stick's reserve of friction is used up; then a turn comes first."""
    (_, _), (_, stick), (_, turned), *_ = route(graph)

    def defect(squared):
        return seen_on(stick, squared, script="s")[1]["stick"][0]

    found = secant(defect, "0.748", "0.7485")
    assert abs(found - mpf(STICK_TURN)) < 1e-14
    assert sorted(simulated(stick, found - mpf("1e-9"), "s")[0]) == sorted("RLs")
    letters, seen = simulated(turned, found + mpf("1e-9"), "ts")
    assert sorted(letters) == sorted("RLst")
    assert 0 < seen["turn"][0] < 1e-8


def test_two_turns_by_brute_force(graph):
    """At the second zero of w' the shaking just beats friction; before, the absorber stuck there for a
    moment."""
    (_, _), (_, _), (_, turned), (_, twice), _ = route(graph)

    def defect(squared):
        return seen_on(twice, squared, script="tt")[1]["turn"][1]

    found = secant(defect, "0.7983", "0.7984")
    assert abs(found - mpf(TWO_TURNS)) < 1e-14
    letters, seen = simulated(turned, found - mpf("1e-9"), "ts")
    assert sorted(letters) == sorted("RLst")
    assert 0 < seen["held"][0] < 1e-7
    assert sorted(simulated(twice, found + mpf("1e-9"), "tt")[0]) == sorted("RLtt")


def test_doubling_by_brute_force(graph):
    branch, doubled = route(graph)[3][1], route(graph)[4][1]

    def defect(squared):
        machine, word, node = brute_orbit(branch, squared)
        return det_plus(machine.derivative(node, word))

    found = secant(defect, "1.1281", "1.1283")
    assert abs(found - mpf(DOUBLING)) < 1e-14
    beside = [brute_orbit(branch, found + side) for side in (mpf("-1e-9"), mpf("1e-9"))]
    below, above = (min(z.real for z in eigenvalues(m.derivative(x, w))) for m, w, x in beside)
    assert below > -1.0 > above
    # beyond, the motion closes after two periods and not after one
    orbit = doubled.orbit(len(doubled) // 2)
    node, letters = left_start(orbit)
    machine = Machine(mpf(orbit.parameters["amplitude"]) ** 2)
    word = {"letters": letters}
    told, end, _ = machine.go((mpf(node[0]), mpf(node[1])), len(letters))
    assert told == letters
    assert abs(end[0] - node[0] - 4 * mp.pi) < 1e-12
    assert abs(end[1] - node[1]) < 1e-12
    middle = machine.go((mpf(node[0]), mpf(node[1])), len(letters) // 2)[1]
    assert abs(middle[1] - node[1]) > 1e-3
    assert max(abs(z) for z in eigenvalues(machine.derivative(node, word, periods=2))) < 1.0


@pytest.mark.parametrize("step", range(5))
def test_orbits_and_multipliers_of_each_branch(graph, step):
    """In the middle of each branch of the route: nodes to 1e-12, multipliers to 1e-10."""
    branch = route(graph)[step][1]
    orbit = branch.orbit(len(branch) // 2)
    guess, letters = left_start(orbit)
    machine = Machine(mpf(orbit.parameters["amplitude"]) ** 2)
    word = {"letters": letters}
    assert machine.go((mpf(guess[0]), mpf(guess[1])), len(letters))[0] == letters
    node = machine.orbit(guess, word, orbit.periods)
    assert abs(node[0] - guess[0]) < 1e-12
    assert abs(node[1] - guess[1]) < 1e-12
    told = eigenvalues(machine.derivative(node, word, orbit.periods))
    assert np.poly(orbit.multipliers) == pytest.approx(np.poly(told), abs=1e-10)


def test_multipliers_jump_at_the_graze(graph):
    """Both sides are kept: a stick forgets, so one multiplier is 0 beyond the velocity graze."""
    point = route(graph)[1][0]
    assert np.abs(point.multipliers).min() > 0.1
    assert np.abs(point.multipliers_beyond).min() < 1e-9


@pytest.mark.parametrize(
    ("friction", "gravity", "mass_ratio"),
    [("0.5", "0.211", "0.006"), ("0.1", "0.422", "0.006"), ("0.3", "0.355", "0.006"), ("0.8", "0.4", "0.05")],
)
def test_sliding_lives_between_its_bounds(friction, gravity, mass_ratio):
    """`tt` from C^2 = h^2 (1 + 4/pi^2), where its turns become sticks, to 1 + h^2, where it grazes the
    walls."""
    h = (1 + mpf(mass_ratio)) * mpf(friction) * mpf(gravity) * mp.pi / 2
    absorber = Absorber(
        restitution=0.76, friction=float(friction), gravity=float(gravity), mass_ratio=float(mass_ratio)
    )
    middle = float(mp.sqrt((h**2 * (1 + 4 / mp.pi**2) + 1 + h**2) / 2))
    graph = cv.diagram(absorber.orbit("tt", amplitude=middle), over="amplitude", within=(0.02, 1.6), depth=0)
    low, high = graph["B1"].range
    assert low**2 == pytest.approx(float(h**2 * (1 + 4 / mp.pi**2)), abs=1e-10)
    assert high**2 == pytest.approx(float(1 + h**2), abs=1e-10)
    ends = {p.kind: p for p in graph.special.values() if p.branch == "B1" and p.real}
    assert ends["stick"].value == pytest.approx(low, abs=1e-14)
    assert ends["wall-graze"].value == pytest.approx(high, abs=1e-14)
    # at the top the absorber turns exactly at the walls, at the bottom it sticks at each turn from there on
    assert np.abs(ends["wall-graze"].orbit.nodes[:, 1]) == pytest.approx(1.0, abs=1e-10)
    assert "s" in graph["B2"].description["word"]
    assert graph["B2"].range[1] == pytest.approx(low, abs=1e-12)
