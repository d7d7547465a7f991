"""Wrong input in Python, and a fragment of the sentence that refuses it: the field, the value or the way out. The command line's are in `contvines/command`."""

# pyright: reportArgumentType=false, reportCallIssue=false, reportAttributeAccessIssue=false
# what is refused here has wrong types on purpose
import pickle
from functools import cache

import numpy as np
import pytest
import scipy.sparse as sp

import contvines as cv
import orbits
from contvines.continuation.settings import Settings
from contvines.problems.functions import ParameterSet
from orbits import Absorber, DryFriction, Machine, Switch, Wall
from orbits import multiple_scales as ms
from orbits.attractors import sweep
from orbits.design import Design
from orbits.design.calibration import from_sweep
from orbits.simulation import simulate
from orbits.words import Word
from tests.machines import ABSORBER, COUPLED, STRONG
from tools.pages.pages import page

UNIT = (-1.0, 1.0)
WALL = {"wall": lambda u, p: u[0]}


def straight(u, p):
    return u - p


def algebraic(F=straight, u0=(0.0,), p0=0.0, **options):
    return cv.AlgebraicProblem(F, list(u0), p0, **options)


def symmetric():
    return ABSORBER.symmetric_orbit(amplitude=0.55)


def diagram(**options):
    return cv.diagram(algebraic(), within=UNIT, **options)


@cache
def line():
    return diagram()


@cache
def response():
    return cv.diagram(symmetric(), over="amplitude", within=(0.2, 0.9), depth=0)


def kind(name="mine", label="MI", **options):
    return cv.Kind(name, label, **({"test": lambda point: 1.0} | options))


def half(point):
    return point.value - 0.5


def with_kind(extra):
    return diagram(kinds=[*cv.KINDS, extra])


def products():
    return cv.AlgebraicProblem(straight_product, [0.25], {"a": 0.5, "b": 0.5})


def straight_product(u, p):
    return u - p.a * p.b


def without_condition():
    half = cv.Kind("half", "HA", test=lambda point: point.u[0] - 0.3)
    graph = cv.diagram(products(), over="a", within=(0.0, 1.0), kinds=[*cv.KINDS, half])
    return cv.locus(graph["HA1"], over="b", within=(0.1, 1.0))


def oscillator(**change):
    return cv.FlowProblem(lambda x, p, *t: [x[1], -x[0] + p.m * x[0] ** 2], [0.1, 0.0], {"m": 1.0}, **change)


def decay(**values):
    return cv.FlowProblem(lambda x, p: [p.a * x[0]], [1.0], {"a": -1.0}).attractor(**values)


def box(**changes):
    """A body between a wall and what `changes` say, as a page."""
    given = {
        "name": "box",
        "states": ("x", "v"),
        "parameters": {"gap": 1.0, "forcing": 0.5, "frequency": 1.0},
        "phase_rate": "frequency",
        "motion": lambda s, phase, p, contact: (s.v, p.forcing * orbits.symbols.cos(phase) - s.x),
        "contacts": [Wall("R", lambda s, phase, p: p.gap - s.x, {"v": -1.0})],
    }
    return Machine(**(given | changes))


def resting():
    return box().orbit("", 1, [[0.0, 0.0, 0.0]], forcing=0.1, frequency=2.0)


def rubbing(s, phase, p, contact):
    return s.v, p.forcing * orbits.symbols.cos(phase) + contact.floor - s.x


def rough(motion=rubbing):
    return box(
        motion=motion,
        contacts=[
            DryFriction("floor", lambda s, phase, p: s.v, "gap"),
            Wall("R", lambda s, phase, p: p.gap - s.x, {"v": -1.0}),
        ],
    )


def sliding_switch():
    return box(
        motion=lambda s, phase, p, contact: (s.v, -5 * contact.side - 0.1 * s.v),
        contacts=[Switch("side", lambda s, phase, p: s.v + s.x)],
    )


def bent(rows=0.0):
    """A cubic that is odd, or not if `rows` is added."""
    return algebraic(lambda u, p: p * u - u**3 + rows * u**2, (0.0,), -1.0, mirror=lambda u: -u)


class Mute:
    dimension, parameter, kernels = 1, "p", None


class OneParameter(cv.ProblemDefaults):
    dimension, kernels, data, workspace, spectrum = 1, None, None, None, "map"


def many_unknowns(sparsity):
    entries = sp.diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(30, 30)).tocsr()

    def F(u, p):
        found = entries @ u + p
        found[7] += u[20]
        return found

    return cv.AlgebraicProblem(
        F, np.zeros(30), 0.0, sparsity=entries != 0.0 if sparsity is None else sparsity
    )


REFUSED = {
    # diagrams and branches
    "empty or reversed": lambda: list(cv.trace(algebraic(), (1.0, 0.0))),
    "outside": lambda: list(cv.trace(algebraic(), (0.5, 1.0))),
    "does not converge": lambda: list(cv.trace(algebraic(lambda u, p: u**2 + 1.0 + 0.0 * p, (0.3,)), UNIT)),
    "name the parameter": lambda: next(cv.trace(symmetric(), within=(0.5, 0.7))),
    "must be an orbit, a special point or a problem": lambda: next(cv.trace("LR", within=(0.5, 0.7))),
    "there is no parameter 'q'; the problem has a, b": lambda: products().against("q"),
    "the seed must be an orbit, a special point or a problem with u0 and p0, not int": lambda: cv.diagram(3),
    "there is no 'tolerence'": lambda: Settings.of({"tolerence": 1e-6}),
    "tolerance": lambda: Settings(tolerance=-1.0),
    "step_rule = 'angle' must be a contvines.StepRule": lambda: Settings(step_rule="angle"),
    "must be a function of": lambda: cv.StepRule(3.0, "three"),
    "step_rule: name = 3": lambda: cv.StepRule(lambda *numbers: 1.0, 3),
    "step_rule 'none': judge returned None for a step": lambda: diagram(
        settings={"step_rule": cv.StepRule(lambda *numbers: None, "none")}
    ),
    "step_rule 'far': judge returned -2.0": lambda: cv.diagram(
        symmetric(),
        over="amplitude",
        within=(0.5, 0.7),
        settings={"step_rule": cv.StepRule(lambda *numbers: -2.0, "far")},
    ),
    "journal = 'line.vines' has no method 'recall'": lambda: diagram(journal="line.vines"),
    "needs the label of a special point as text, for example 'EP1', the label of": lambda: cv.switch(
        line(), line()["EP1"]
    ),
    "B1 has no measure 'speed'; choose one of norm, p": lambda: line().plot(y="speed"),
    "EP1 is a point of kind end; invariant circles": lambda: response()["EP1"].circles(),
    "the graph has no 'LP7'": lambda: line().plot(labels=["LP7"]),
    "give True, False or a list": lambda: line().plot(labels="BP1"),
    "color = 'kind' is unknown; choose one of branch, word, stability": lambda: line().plot(color="kind"),
    "interrupt = 'stop'": lambda: diagram(interrupt="stop"),
    "nothing to go on with": lambda: cv.resume(line()),
    # kinds of one's own
    "small letters": lambda: kind("Neutral saddle"),
    "used by another": lambda: with_kind(kind(label="LP")),
    "no test function": lambda: with_kind(cv.Kind("mine", "MI")),
    "contvines.Kind": lambda: with_kind("fold"),
    "kind mine: its test fails at p": lambda: with_kind(kind(test=lambda point: point.velocity)),
    "kind mine: its test returns True at p = ": lambda: with_kind(kind(test=lambda point: True)),
    "kind mine: its test returns (1+2j) at p = ": lambda: with_kind(kind(test=lambda point: 1.0 + 2.0j)),
    "kind mine: its verify returns None at p = ": lambda: with_kind(
        kind(test=half, verify=lambda point: None)
    ),
    "kind mine: its classify returns ('odd', 1.0) at p = ": lambda: with_kind(
        kind(test=half, classify=lambda point: ("odd", 1.0))
    ),
    "kind mine: locus = 'fold' must be a function": lambda: kind(locus="fold"),
    "kind mine: marker = 'zz'": lambda: kind(marker="zz"),
    "kinds is a Kind; expected a list": lambda: diagram(kinds=kind()),
    "no condition to follow": without_condition,
    # two parameters
    "over = 'amplitude' is the parameter of the diagram itself": lambda: cv.locus(
        response()["LP1"], over="amplitude", within=(0.1, 0.9)
    ),
    "over = 'viscosity': the problem has no such parameter; it has amplitude": lambda: cv.locus(
        response()["LP1"], over="viscosity", within=(0.1, 0.9)
    ),
    "was made at friction = 0.5, outside of within": lambda: cv.locus(
        response()["LP1"], over="friction", within=(0.6, 0.9)
    ),
    "within = [0.9, 0.2] is empty or reversed": lambda: cv.chart(
        response(), over="friction", within=(0.9, 0.2)
    ),
    "friction = -1 is out of range": lambda: cv.chart(response(), over="friction", within=(-1.0, 0.9)),
    # what coexists
    "budget = 1.5": lambda: cv.atlas(ABSORBER, over="amplitude", within=(0.3, 0.8), budget=1.5),
    "values: 9 lies outside": lambda: cv.atlas(ABSORBER, over="amplitude", within=(0.3, 0.8), values=[9.0]),
    "lies outside the interval of saddles": lambda: cv.basins(
        ABSORBER, "amplitude", 0.95, points=2, saddles=response()
    ),
    "choose the plane w, w_rate, with all other coordinates zero": lambda: cv.basins(
        ABSORBER, "amplitude", 0.3, points=4, saddles=response(), fixed={"phase": 1.0}
    ),
    "the graph's parameter is amplitude, not friction": lambda: cv.basins(
        ABSORBER.population("friction", amplitude=0.55), at=0.3, points=4, saddles=response()
    ),
    "has no stable real motion at amplitude = 0.21": lambda: cv.robustness(response()["B1"], 0.21),
    # equations of one's own
    "as many are needed": lambda: algebraic(lambda x, p: [1.0, 2.0]),
    "not finite": lambda: algebraic(lambda x, p: x + np.nan),
    "spectrum": lambda: algebraic(spectrum="map"),
    "F returns an array of shape (1, 2)": lambda: algebraic(lambda u, p: [[p - u[0], u[1]]], (0.0, 0.0)),
    "mirror returns 1 numbers for 2 unknowns": lambda: cv.diagram(
        algebraic(lambda u, p: p * u - u**3, (0.0, 0.0), -1.0, mirror=lambda u: u[:1]), within=UNIT
    ),
    "mirror is no symmetry of F: at u =": lambda: bent(1e-4),
    "mirror is no symmetry of the map": lambda: cv.MapProblem(
        lambda x, p: p * x * (1.0 - x), [0.5], 2.0, mirror=lambda x: -x
    ),
    "sparsity lacks an entry of F in row 7": lambda: many_unknowns(None),
    "largest entry of F is 1.3": lambda: cv.diagram(
        algebraic(lambda u, p: [p - abs(u[0] - 0.3) - u[0]], (-1.0,), 1.6), within=(0.0, 2.0)
    ),
    "F returns None; numbers are needed": lambda: algebraic(lambda u, p: None),
    "jacobian = '3-point' must be": lambda: algebraic(jacobian="3-point"),
    "derivative['q']": lambda: algebraic(derivative={"q": straight}),
    "derivative = a csr_array must be a function": lambda: algebraic(derivative=sp.csr_array([[1.0]])),
    "row 1 of F is zero": lambda: algebraic(lambda u, p: [u[0] - p, 0.0], (0.0, 1.0)),
    "F cannot be called as F(u, p, sign)": lambda: algebraic(u0=(0.5,), p0=1.0, switches=WALL),
    "no switch 'wal' (did you mean 'wall'?); the problem has wall": lambda: cv.MapProblem(
        lambda x, p, sign: p - x * sign["wal"], [0.5], 1.0, switches=WALL
    ),
    "r = 'x' must be a number": lambda: ParameterSet({"r": "x"}, "r"),
    "p[0]: parameters have names; p.a or p['a'] is one": lambda: cv.AlgebraicProblem(
        lambda u, p: u - p[0], [0.0], {"a": 0.0}
    ),
    "it is called with two arguments, the unknowns and the parameters": lambda: cv.AlgebraicProblem(
        lambda t, u, p: u, [0.0], 0.0
    ),
    "at least one": lambda: ParameterSet({}, "r"),
    "there is no parameter 'c'; the problem has a, b": lambda: cv.AlgebraicProblem(
        straight_product, [0.25], {"a": 0.5, "b": 0.5}, parameter="c"
    ),
    "Mute lacks": lambda: cv.diagram(Mute(), within=(0.0, 1.0)),
    "n_multipliers = 0; give": lambda: cv.diagram(OneParameter(), within=(0.0, 1.0)),
    "gravity cannot vary: a OneParameter has the one parameter 'p'": lambda: OneParameter().against(
        "gravity"
    ),
    # flows
    "mirror": lambda: oscillator(mirror=[[1, 0], [0, -1]]),
    "mirror raises IndexError": lambda: oscillator(mirror=lambda x: x[5]),
    "mirror returns [nan, nan]": lambda: oscillator(mirror=lambda x: np.nan * x),
    "rest": decay,
    "nowhere.so": lambda: cv.flows.CompiledRates("nowhere.so"),
    "give a better guess": lambda: cv.diagram(
        cv.FlowProblem(lambda x, p: [x[0] ** 2 + 1 + p.a], [1.0], {"a": 1.0}), within=(0.5, 2.0)
    ),
    "must be functions by name": lambda: oscillator(events=[1]),
    "must be a name with a function": lambda: oscillator(events={"wall": 1}),
    "wall is 0 at x0": lambda: oscillator(events={"wall": lambda x, p: x[1]}),
    "the event wall fails": lambda: oscillator(events={"wall": lambda x, p: x[5]}),
    "has 1 names; the flow has 2 states": lambda: oscillator(states=("x",)),
    "'x' is there twice": lambda: oscillator(states=("x", "x")),
    "that of a measure": lambda: oscillator(states=("x", "period")),
    "must be names": lambda: oscillator(states="xy"),
    "period is inf at the start": lambda: oscillator(period=np.inf),
    "period = '2' must be a positive number": lambda: oscillator(period="2"),
    "period raises AttributeError: there is no parameter 'omega'": lambda: oscillator(
        period=lambda p: p.omega
    ),
    "called with (x, p, t), as there is period=": lambda: cv.FlowProblem(
        lambda x, p: [p.a - x[0]], [1.0], {"a": 1.0}, period=2.0
    ),
    "it is called with (x, p, t)": lambda: cv.FlowProblem(
        lambda x, t, p: [p.a * x[0] + np.cos(t)], [1.0], {"a": 1.0}, period=2.0 * np.pi
    ),
    "period = 6 at the start is no period of f(x, p, t) in t": lambda: cv.FlowProblem(
        lambda x, p, t: [np.cos(p.w * t) - x[0]], [0.0], {"w": 0.5}, period=lambda p: 3.0 / p.w
    ),
    "settings = 'loose' must be values by name": lambda: oscillator(settings="loose"),
    "there is no 'longst' of a flow (did you mean 'longest'": lambda: oscillator(settings={"longst": 10.0}),
    "near = -1.0 must be a positive number": lambda: oscillator(settings={"near": -1.0}),
    "did you mean 'gain'": lambda: cv.FlowProblem(lambda x, p: [p.gai * x[0]], [1.0], {"gain": 1.0}),
    "parameters have names: p.a": lambda: cv.FlowProblem(lambda x, a: [a * x[0]], [1.0], {"a": 1.0}),
    "did you mean 'm'": lambda: cv.diagram(oscillator(), over="M", within=(0, 2)),
    "one of 'a', 'b'": lambda: cv.diagram(
        cv.FlowProblem(lambda x, p: [p.a - p.b * x[0]], [1.0], {"a": 1.0, "b": 1.0}), within=(0, 2)
    ),
    "there is no parameter 'M' (did you mean": lambda: oscillator().attractor(M=3.0),
    "x0 = [nan, 0.0] must be finite": lambda: oscillator().attractor([np.nan, 0.0]),
    "transient = nan must be a positive time": lambda: oscillator().attractor(transient=np.nan),
    "transient = -1.0 must be a positive time": lambda: oscillator().attractor(transient=-1.0),
    "longest = 0 must be a whole number, 1 or more": lambda: oscillator().attractor(longest=0),
    "doublings = 1.5 must be a whole number": lambda: oscillator().attractor(doublings=1.5),
    "states must be finite": lambda: oscillator().cycle(range(6), np.full((6, 2), np.nan)),
    "times must be numbers": lambda: oscillator().cycle("abc", np.ones((6, 2))),
    "rounds = 0 must be a whole number": lambda: oscillator().cycle(range(6), np.ones((6, 2)), rounds=0),
    "low < high": lambda: oscillator().population("m", box=[(1, -1), (-1, 1)]),
    "give 2 pairs": lambda: oscillator().population(box=[(0.0, 1.0), (1.0,)]),
    "(1.0, inf)]: give 2 pairs": lambda: oscillator().population(box=[(0.0, 1.0), (1.0, np.inf)]),
    "around has shape (4, 3)": lambda: oscillator().population(around=np.ones((4, 3))),
    "at = nan": lambda: cv.basins(oscillator().population(), at=np.nan, points=4),
    # machines, words and orbits
    "restitution = 1.4": lambda: Absorber(**STRONG | {"restitution": 1.4}),
    "begins at": lambda: ABSORBER.symmetric_orbit(0.1),
    "the other way": lambda: ABSORBER.orbit(
        "s-s+", amplitude=0.115, guess=ABSORBER.orbit("s+s-", amplitude=0.115).nodes
    ),
    "one [phase": lambda: ABSORBER.orbit("LR", amplitude=0.5, guess=[[1.0, 2.0]]),
    "simulator finds": lambda: ABSORBER.orbit("LRLtLt", amplitude=0.3),
    "word = 1000 is no word: give the events of a period as text, such as 'LR'": lambda: ABSORBER.orbit(
        1000, amplitude=0.5
    ),
    "no symmetric orbit with two impacts": lambda: COUPLED.symmetric_orbit(frequency=0.9),
    "letter 'X'": lambda: Word.parse("LX"),
    "cannot come next": lambda: Word.parse("LtR"),
    # simulation
    "w = 1.2 lies outside": lambda: simulate(ABSORBER, {"w": 1.2}, amplitude=0.5, periods=1),
    "how long": lambda: simulate(ABSORBER, {}, amplitude=0.5),
    "'forcing' is no parameter": lambda: sweep(ABSORBER, "forcing", [1.0]),
    # pages
    "motion must be affine in contact.floor": lambda: rough(
        lambda s, phase, p, contact: (s.v, contact.floor**2 - s.x)
    ),
    "gap = -1 is out of range: the limit of friction 'floor' is 0 or above": lambda: rough().vector(
        {"gap": -1.0}
    ),
    "mass is no parameter of the machine 'box'; it has": lambda: box().simulate(periods=1, mass=1.0),
    "the gap of wall 'R' is -1 at the start: bodies overlap": lambda: box().simulate({"x": 2.0}, periods=1),
    "has the letter 'L': this machine has t (turn), s (stick), u (slip), R (impact)": lambda: rough().word(
        "RL"
    ),
    "switch 'side': both flows lead to its surface, so the motion would slide": lambda: (
        sliding_switch().simulate({"x": 0.01, "v": 0.05}, time=100.0)
    ),
    "left the range of numbers": lambda: box(motion=lambda s, phase, p, contact: (s.v, 50 * s.x**3)).simulate(
        {"x": -3.0, "v": -1.0}, periods=2
    ),
    "offers no proofs, for flights of declared machines have no closed form": lambda: (
        page("impact_oscillator").orbit("R", 1, frequency=2.0).prove()
    ),
    "no state": lambda: box(starts={"y": (0, 1)}),
    # animations
    "a.avi: an animation": lambda: symmetric().animate("a.avi"),
    "no folder": lambda: symmetric().animate("none/a.gif"),
    "seconds = 0.0": lambda: symmetric().animate("a.gif", seconds=0.0),
    "'box' cannot go to another process": lambda: pickle.dumps(box()),
    "response = 'max_x2': expected max_x, min_x, max_abs_x": lambda: box(response="max_x2"),
    "'box' is forced: its motions without events are orbits with the word ''": lambda: box().smooth(),
    "forcing is missing": lambda: orbits.Coupled(**STRONG).vector(),
    "gravity pulls it to a wall and keeps it there": lambda: orbits.Cavity(
        restitution=0.5, friction=0.1, gravity=0.3, slope=0.5, mass_ratio=0.0
    ).orbit("", amplitude=0.05),
    # quantities, design and theory
    "cavity = 0.0 must be positive": lambda: Design(cavity=[0.01, 0.0]),
    "measure = 'max_q1' is no measure of a sweep of 'coupled' (did you mean 'max_abs_q1'?)": lambda: (
        from_sweep(orbits.Coupled(**STRONG), "frequency", [1.0], [1.0], {"forcing": 0.1}, measure="max_q1")
    ),
    "one parameter set": lambda: ms.equilibria(ms.SlowFlow(), np.array([0.0, 1.0])),
    "without friction": lambda: ms.best_clearance(ms.SlowFlow()),
    "no linear peak": lambda: ms.tuned_backbone(ms.SlowFlow(friction=0.0, damping=0.0)),
    "C_min": lambda: ms.integrate(ms.SlowFlow(), 0.0, 0.1, 0.0, 1.0),
    # misspelt names
    "diagram has no argument 'dept' (did you mean 'depth'?); it has seed, over": lambda: diagram(dept=3),
    "use settings={'max_step': 0.01}": lambda: diagram(max_step=0.01),
    "chart needs within (Interval of the second parameter)": lambda: cv.chart(line(), over="q"),
    "Absorber needs friction (Coulomb coefficient) and gravity": lambda: Absorber(restitution=0.76),
    "Absorber takes its parameters by name, as restitution=0.76, not 0.5 alone": lambda: Absorber(0.5),
    "MapProblem has no argument 'paramter' (did you mean 'parameter'?); it has f": lambda: cv.MapProblem(
        straight, [1.0], paramter="mu"
    ),
    "settings: there is no 'max_stp' (did you mean 'max_step'?)": lambda: diagram(settings={"max_stp": 0.1}),
    "legend = 'insid' is unknown (did you mean 'inside'?); choose of inside": lambda: line().plot(
        legend="insid"
    ),
    "contvines has no 'daigram' (did you mean 'diagram'?)": lambda: cv.daigram,
    "B1.orbit(1.5): give the number of a point, from 0": lambda: line()["B1"].orbit(1.5),
    "Absorber has no parameter 'frction' (did you mean 'friction'?)": lambda: Absorber(frction=0.5),
    "Absorber.symmetric_orbit has no argument 'amplitde' (did you mean": lambda: ABSORBER.symmetric_orbit(
        amplitde=0.5
    ),
    "events are of built-in machines; 'box' is declared: its orbits have nodes": lambda: resting().events,
    "parameter = 'gp' is unknown to the model 'box' (did you mean 'gap'?)": lambda: resting().problem("gp"),
    "within = [-1, 3]: frequency = -1: a forcing frequency is above 0": lambda: cv.diagram(
        resting(), over="frequency", within=(-1, 3)
    ),
    "within = [0.2, 2]: restitution = 2 is out of range; give a number above 0": lambda: cv.diagram(
        symmetric(), over="restitution", within=(0.2, 2.0)
    ),
    "at = 'x': the value of m must be a finite number": lambda: cv.basins(oscillator().population(), at="x"),
    "Machine has no argument 'state' (did you mean 'states'?); it has name": lambda: Machine(
        name="stop", state=("x", "v")
    ),
}


@pytest.mark.parametrize("sentence", REFUSED)
def test_wrong_input_is_refused_in_a_sentence(sentence):
    with pytest.raises((ValueError, TypeError, AttributeError, ArithmeticError, RuntimeError)) as refusal:
        REFUSED[sentence]()
    assert sentence in str(refusal.value)
    assert len(str(refusal.value)) < 700
