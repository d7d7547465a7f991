"""Starts of the loci that leave a point of codimension two: loci that pass through it, and loci of motions that are born there.

The motions that are born are cycles of twice the period, cycles around an equilibrium, and homoclinic orbits near a Bogdanov-Takens point. The first
homoclinic orbit is computed from its asymptotics. On the centre manifold x = x0 + H(w, b), with the unfolding parameters b and p = p0 + K(b), the flow is

    w1' = w2,    w2' = b1 + b2 w2 + a w1^2 + b w1 w2 + ...

H and K follow from F(H, K) = DH w' degree by degree (Kuznetsov, Meijer, Al Hdaibat and Govaerts, Int. J. Bifurc. Chaos 24 (2014) 1450057). With
w1 = e^2 v / a, w2 = e^3 v' / a, a time s = e t, b1 = -4 e^4 / a and b2 = (b / a) e^2 r it is v'' = v^2 - 4 + e (b / a) v' (r + v), whose orbit
homoclinic to v = 2 is

    v = 2 - 6 / cosh(s)^2 - e (b / a) (72 / 7) sinh(s) log(cosh(s)) / cosh(s)^3 + O(e^2),    r = 10 / 7 + O(e^2).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from ..bifurcation.kinds import CODIMENSION_TWO
from ..continuation.engine import Engine
from ..continuation.settings import Settings
from ..flows import mesh
from ..flows.cycles import CycleProblem
from ..flows.equilibria import Equilibria
from ..flows.mesh import rule
from ..problems.abilities import Adaptive
from ..problems.protocol import Embedding
from .adaptive import on_mesh
from .kernels import BRANCH
from .linear import Linearisation
from .locus import Locus, PlanePoint
from .plane import BEND
from .starts import Candidate, begin, of_period

Interval = tuple[float, float]

#: kind of a point -> kinds of the loci of the same problem that pass through it
PASSING = {
    "bogdanov-takens": ("fold", "hopf"),
    "zero-hopf": ("fold", "hopf"),
    "double-hopf": ("hopf",),
    "generalized-hopf": ("hopf",),
    "resonance-1-1": ("fold", "neimark-sacker"),
    "resonance-1-2": ("period-doubling", "neimark-sacker"),
    "fold-flip": ("fold", "period-doubling"),
    "fold-symmetry-breaking": ("fold", "symmetry-breaking"),
    "fold-neimark-sacker": ("fold", "neimark-sacker"),
    "flip-neimark-sacker": ("period-doubling", "neimark-sacker"),
    "symmetry-breaking-neimark-sacker": ("symmetry-breaking", "neimark-sacker"),
    "double-neimark-sacker": ("neimark-sacker",),
    "border-fold": ("fold",),
    "border-flip": ("period-doubling",),
    "border-symmetry-breaking": ("symmetry-breaking",),
    "border-neimark-sacker": ("neimark-sacker",),
}
TWO_PAIRS = (
    "double-hopf",
    "double-neimark-sacker",
)  # a locus of each of the two pairs passes through the point
#: kind of a point -> kind of the locus of cycles of twice the period that begins there; the second table holds for cycles of flows only
DOUBLED = {"generalized-period-doubling": "fold"}
DOUBLED_CYCLES = {"resonance-1-2": "neimark-sacker", "fold-flip": "neimark-sacker"}
#: kind of a point -> kind of the locus of cycles around an equilibrium that begins there
SMALL = {"generalized-hopf": "fold", "zero-hopf": "neimark-sacker", "double-hopf": "neimark-sacker"}
START_SHIFT = 0.01  # distance from a crossing of branches at which a locus is started, as part of the first parameter's interval
# amplitudes of the new motion at which its special point is tried, relative to the motion's size
AMPLITUDES = (0.05, 0.02, 0.1, 0.005)
# the same for cycles of flows: at smaller amplitudes the tests nearly vanish
AMPLITUDES_OF_CYCLES = (0.1, 0.2, 0.05, 0.4)


def leaving(point: PlanePoint, locus: Locus, bounds: Interval, over: str) -> Iterator[Candidate]:
    """Generate starts of the loci that pass through a point, or begin there.

    Parameters
    ----------
    point : PlanePoint
    locus : Locus
        A locus on which the point was found.
    bounds : (float, float)
        Interval of the first parameter.
    over : str
        Name of the second parameter.
    """
    problem, u, (p, q) = point.attached, point.u, point.value
    # on a locus of branch points two branches cross, and neither of them folds
    crossing = locus.problem is not None and locus.problem.condition == BRANCH
    for kind in PASSING.get(point.kind, ()):
        if kind == "neimark-sacker" and problem.spectrum != "map":
            continue
        if not crossing:
            for pair in (0, 1) if point.kind in TWO_PAIRS else (None,):
                yield Candidate(problem, kind, u, p, q, point.label, pair=pair)
        elif kind != "fold":  # start next to the crossing, where the equations are regular
            for shift in (-START_SHIFT, START_SHIFT):
                yield Candidate(problem, kind, u, p + shift * (bounds[1] - bounds[0]), q, point.label)
    if point.kind in CODIMENSION_TWO and CODIMENSION_TWO[point.kind].border:
        for j in point.margins:
            yield Candidate(problem, problem.margin_kind(j), u, p, q, point.label, j)
    if point.kind == "bogdanov-takens":
        yield from homoclinic_of(point, bounds, locus.within)
    doubled = DOUBLED | DOUBLED_CYCLES if isinstance(problem, Adaptive) else DOUBLED
    if point.kind in doubled:
        yield from _specials_beside(point, doubled[point.kind], _doubled(point), bounds, over, locus.within)
    elif point.kind in SMALL:
        children = problem.offspring("hopf", u, p, np.zeros(len(u) + 1), 1j)
        yield from _specials_beside(point, SMALL[point.kind], children, bounds, over, locus.within)


# ------------------------------------------------------------------ motions of a small amplitude
def _doubled(point: PlanePoint) -> Iterator[Embedding]:
    """The motion as one of twice the period, with the direction in which motions of twice the period leave it."""
    problem, (p, _) = point.attached, point.value
    right = Linearisation(problem).at(point.u, p).null_vectors(flipped=True).right
    for child in problem.offspring(problem.flip_kind, point.u, p, np.append(right, 0.0), -1.0 + 0.0j)[:1]:
        states = problem.states if isinstance(problem, CycleProblem) else len(point.u)
        direction = np.array(child.tangent, dtype=float)
        direction[states : 2 * states] *= -1.0
        direction[2 * states :] = 0.0
        yield child._replace(tangent=direction)


def _specials_beside(
    point: PlanePoint,
    kind: str,
    children: Iterable[Embedding],
    bounds: Interval,
    over: str,
    within: Interval,
) -> Iterator[Candidate]:
    """Generate special points of a kind on the motions that are born at a point, with a given small amplitude."""
    p, q = point.value
    for child in children:
        problem, start, direction = child.problem, np.asarray(child.u, dtype=float), child.tangent[:-1]
        units = Linearisation(problem).units
        cycles = isinstance(problem, Adaptive)  # cycles of a flow have many unknowns: use the maximum norm
        direction = direction / np.linalg.norm(direction / units, np.inf if cycles else 2)
        n = len(direction)
        for amplitude in AMPLITUDES_OF_CYCLES if cycles else AMPLITUDES:
            size = amplitude * (1.0 + float(np.abs(start / units).max()))
            guess = start + size * direction
            locus = begin(Candidate(problem, kind, guess, p, q, point.label), over, bounds)
            border = np.zeros(locus.dimension + 1)
            border[:n] = direction / units**2
            engine = Engine(locus, within, Settings())
            solved = engine.solve(locus.joined(guess, p), q, border, float(border[:n] @ guess))
            if solved is None or np.abs((solved.u[:n] - guess) / units).max() > 10.0 * size:
                continue
            value = float(locus.split(solved.u)[1])
            yield Candidate(locus.at(solved.p), kind, solved.u[:n], value, solved.p, point.label)
            break


# ------------------------------------------------------------------ homoclinic orbits
SIDE = 10.0  # half of the period in the scaled time s: the orbit approaches the saddle to 4 exp(-2 SIDE) of its size
INTERVALS = 40  # intervals of the first mesh
STEP = 0.01  # step of differences, in units of the states and of the parameters
# sizes of the first orbit, and changes of the parameters, in these units; tried in this order
SHARES = (0.1, 0.03, 0.01, 0.003)
LEAST_RATIO = 0.5  # smallest ratio of the size of a solved orbit to the predicted one


class Asymptotics:
    """Homoclinic orbits near a Bogdanov-Takens point, to first order in e; see the top of this module.

    Parameters
    ----------
    problem : Equilibria
        Equilibria at the point's value of the second parameter.
    u : ndarray, shape (d,)
    value : (float, float)
        Values of the two parameters at the point.
    over : str
        Name of the second parameter.
    units : (float, float)
        Units of the two parameters.
    """

    def __init__(
        self,
        problem: Equilibria,
        u: np.ndarray,
        value: tuple[float, float],
        over: str,
        units: tuple[float, float],
    ) -> None:
        self.flow, self.values, self.over, d = problem.flow, problem.values, over, problem.node
        lengths = self.flow.field.lengths if problem.scales is None else problem.scales.unknowns[:d]
        self.start, self.units, self.d = np.array([*u[:d], *value]), np.array([*lengths, *units]), d
        slopes = np.array([self._derivatives_along(unit)[0] for unit in np.eye(d + 2)]).T
        matrix, by_value = slopes[:, :d], slopes[:, d:]
        left, _, right = np.linalg.svd(matrix)
        v, w = right[-1], left[:, -1]
        bordered = np.block([[matrix, w[:, None]], [v[None], np.zeros((1, 1))]])

        def solved(side: np.ndarray, whole: np.ndarray = bordered) -> np.ndarray:
            return np.linalg.solve(whole, np.append(side, 0.0))[:-1]

        q1, p0 = solved(v), solved(w, bordered.T)
        w, p0 = w / (w @ q1), p0 / (w @ q1)
        p0 = p0 - (p0 @ q1) * w
        nothing = np.zeros(2)
        first, second = np.append(v, nothing), np.append(q1, nothing)
        square = self._mixed(first, first)
        self.a, self.b = 0.5 * float(w @ square), float(w @ self._mixed(first, second) + p0 @ square)
        normal = w @ by_value
        normal = normal / (normal @ normal)
        flat = np.array([-normal[1], normal[0]])
        ahead = np.append(-solved(by_value @ flat), flat)
        bends = [(self._mixed(first, along), self._mixed(second, along)) for along in (ahead, first)]
        system = np.array([[w @ one for one, _ in bends], [p0 @ one + w @ other for one, other in bends]])
        parts = np.linalg.solve(system, [0.0, 1.0])
        self.by_second = parts[0] * ahead + parts[1] * first
        bend = -0.5 * float(w @ self._mixed(self.by_second, self.by_second))
        self.states, self.across, self.bend = (first, second), np.append(np.zeros(d), normal), bend

    def _line(self, direction: np.ndarray) -> np.ndarray:
        """Rates at seven points along a direction, in units of the states."""
        found = []
        for k in range(-3, 4):
            z = self.start + STEP * k * direction * self.units
            values = self.values.against(self.values.varying, {self.over: z[-1]})
            found.append(self.flow.field.against(values)(z[None, : self.d], z[-2])[0])
        return np.array(found) / self.units[: self.d]

    def _derivatives_along(self, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and second derivatives of the rates along a direction."""
        line = self._line(direction)
        slope = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
        return slope @ line / STEP, BEND @ line / STEP**2

    def _mixed(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Mixed second derivative of the rates along two directions."""
        return 0.25 * (self._derivatives_along(one + other)[1] - self._derivatives_along(one - other)[1])

    def largest(self, share: float) -> float:
        """Return the e at which the size of the orbit, or the change of a parameter, is a given share of its unit."""
        shift = 10.0 / 7.0 * np.abs(self.b / self.a * self.by_second)
        size = np.maximum(6.0 / abs(self.a) * np.abs(self.states[0]), shift)
        return float(np.sqrt(share / size.max()))

    def orbit(self, e: float, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        """Return the states at places in units of the period, the two parameters, and the period."""
        s = SIDE * (2.0 * places - 1.0)
        c, t, ratio = np.cosh(s), np.tanh(s), self.b / self.a
        v = 2.0 - 6.0 / c**2 - e * ratio * 72.0 / 7.0 * t * np.log(c) / c**2
        speed = 12.0 * t / c**2
        second = ratio * e**2 * 10.0 / 7.0
        z = self.by_second * second + self.across * (-4.0 * e**4 / self.a + self.bend * second**2)
        curve = z + (e**2 * v[:, None] * self.states[0] + e**3 * speed[:, None] * self.states[1]) / self.a
        curve = self.start + curve * self.units
        return curve[:, : self.d], curve[0, self.d :], 2.0 * SIDE / e


def homoclinic_of(point: PlanePoint, bounds: Interval, within: Interval) -> Iterator[Candidate]:
    """Generate one cycle of a long period that represents the homoclinic orbit near a Bogdanov-Takens point of a flow; none if the point is degenerate."""
    problem, (p, q) = point.attached, point.value
    if not isinstance(problem, Equilibria):
        return
    units = [
        high - low if np.isfinite(high - low) else max(abs(value), 1.0)
        for (low, high), value in zip((bounds, within), (p, q))
    ]
    over = point.parameters[1]
    try:
        near = Asymptotics(problem, point.u, (p, q), over, (units[0], units[1]))
    except (ValueError, np.linalg.LinAlgError):
        return
    flow, widths, scale = problem.flow, np.full(INTERVALS, 1.0 / INTERVALS), near.units[: near.d]
    places = mesh.node_places(rule(flow.degree), widths)
    for share in SHARES:
        x, (first, second), period = near.orbit(near.largest(share), places)
        if not within[0] <= second <= within[1]:
            continue
        field = flow.field.against(
            problem.values.against(problem.parameter, {problem.parameter: first, over: second})
        )
        u = np.concatenate([x.reshape(-1), [period], widths])
        unit = 1.0 if problem.scales is None else problem.scales.parameter
        cycles = flow.cycles(field, u, (INTERVALS, 1, 1), (scale, period, unit))
        found = of_period(on_mesh(cycles), u, first, period)
        if found is None:
            continue
        end, u, first = found
        size, wanted = (np.ptp(y.reshape(-1, near.d) / scale, axis=0).max() for y in (u[: end.states], x))
        if size > LEAST_RATIO * wanted:
            yield Candidate(end, "homoclinic", u, first, second, point.label)
            return
