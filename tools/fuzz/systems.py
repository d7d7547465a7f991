"""Random polynomial systems whose branches are known exactly, from resultants by sympy.

    python -m tools.fuzz.systems 500 [FIRST_SEED]

A plane curve g(x, p) = 0, often reducible, is written in two or three unknowns: y = q(x, p), z = s(x, y, p); then unknowns and rows
are mixed by unimodular matrices. The exact structure is known: parameter values at which real roots of g(., p) meet or go to infinity are the
roots of the discriminant and of the leading coefficient. Between two of these values the roots are arcs in a fixed order; at each value
those arcs are connected that end in the multiple root. An arc towards a pole must be followed only within `escape`,
if a branch ends with this reason. Systems with two such values closer than CLOSE, or with singular points other than
folds and simple branch points, are not used.
"""

from __future__ import annotations

import contextlib
import itertools
import sys
import time
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np
import sympy as sy

import contvines as cv
from contvines.branches import Reason

LOW, HIGH, CLOSE = -2.0, 2.0, 3e-3
WIDE = 1e-8  # smallest width of an unresolved interval that counts
X, P, Y, Z = sy.symbols("x p y z")


class Unsuitable(ValueError):
    """A system whose structure is not determined exactly."""


class Special(NamedTuple):
    """A fold or branch point of the curve."""

    kind: str
    value: float
    x: float


class Curve:
    """Arcs of g(x, p) = 0 in the interval, and their connections.

    Attributes
    ----------
    ends : list of float
        Critical values and the ends of the interval; arcs lie between neighbours.
    middles : list of (float, list of float)
        A value between each two neighbours, and the roots there.
    """

    def __init__(self, g: Any) -> None:
        self.g = sy.Poly(g, X, P)
        if sy.Poly(g, X).content().has(P) or len(sy.Poly(g, X).all_coeffs()) < 2:
            raise Unsuitable("a line of constant p")
        self.gx, self.gp = self.g.diff(X), self.g.diff(P)
        lead = sy.Poly(self.g.as_expr(), X).LC()
        discriminant = sy.discriminant(self.g.as_expr(), X)
        if discriminant == 0:
            raise Unsuitable("a factor twice")
        values: list[Any] = []
        for part in (discriminant, lead):
            for factor, _ in sy.factor_list(part, P)[1]:
                values += [mp.mpf(str(r.evalf(30))) for r in sy.Poly(factor, P).real_roots()]
        values = sorted(v for v in values if LOW - CLOSE < v < HIGH + CLOSE)
        bounds = [mp.mpf(LOW), *values, mp.mpf(HIGH)]
        if any(b - a < CLOSE for a, b in itertools.pairwise(bounds)):
            raise Unsuitable("values too close to one another")
        self.ends, self.specials = bounds, []
        self.middles = [(float((a + b) / 2), self.roots((a + b) / 2)) for a, b in itertools.pairwise(bounds)]
        self.links: dict[tuple[int, int], list[tuple[tuple[int, int], Special | None]]] = {}
        for k, value in enumerate(values):
            self._join(k, value)

    def roots(self, p: Any) -> list[float]:
        """Return the real roots at a value, ascending."""
        with mp.workdps(30):
            c = [
                mp.mpf(str(sy.N(a.subs(P, sy.Float(str(p), 30)), 30)))
                for a in sy.Poly(self.g.as_expr(), X).all_coeffs()
            ]
            while c and abs(c[0]) < mp.mpf(10) ** -25:
                c = c[1:]
            if len(c) < 2:
                return []
            found = mp.polyroots(c, maxsteps=300, extraprec=200, error=False)
            return sorted(float(mp.re(r)) for r in found if abs(mp.im(r)) < mp.mpf(10) ** -12)

    def _join(self, k: int, value: Any) -> None:
        """Connect the arcs on both sides of a critical value."""
        step = mp.mpf(10) ** -9
        left, right = self.roots(value - step), self.roots(value + step)
        if len(left) != len(self.middles[k][1]) or len(right) != len(self.middles[k + 1][1]):
            raise Unsuitable("roots lost")
        at = self._double(value)
        bounded = 1e4
        reach = 1e-3
        inner = [
            [i for i, x in enumerate(side) if at is not None and abs(x - at) < reach]
            for side in (left, right)
        ]
        rest = [
            [i for i, x in enumerate(side) if i not in near and abs(x) < bounded]
            for side, near in zip((left, right), inner)
        ]
        if len(rest[0]) != len(rest[1]):
            raise Unsuitable("arcs that cannot be matched")
        for i, j in zip(*rest):
            self._link((k, i), (k + 1, j), None)
        if at is None:
            return
        p = float(value)
        slopes = [
            float(abs(f.eval({X: sy.Float(at, 30), P: sy.Float(str(value), 30)}))) for f in (self.gx, self.gp)
        ]
        size = max(len(inner[0]), len(inner[1]))
        if slopes[1] < 1e-6:
            if size == 0:
                return  # an isolated point
            if (len(inner[0]), len(inner[1])) not in {(2, 2), (1, 3), (3, 1)}:
                raise Unsuitable("a cusp")
            place = {X: sy.Float(at, 30), P: sy.Float(str(value), 30)}
            gxx, gxp, gpp = (
                float(f.eval(place)) for f in (self.gx.diff(X), self.gx.diff(P), self.gp.diff(P))
            )
            if not gxx * gpp - gxp**2 < -1e-6:
                raise Unsuitable("branches that touch")
            special = Special("branch-point", p, at)
        elif sorted(map(len, inner)) == [0, 2]:
            special = Special("fold", p, at)
        else:
            raise Unsuitable("a degenerate fold")
        nodes = [(k, i) for i in inner[0]] + [(k + 1, j) for j in inner[1]]
        self.specials.append(special)
        for a in nodes:
            for b in nodes:
                if a != b:
                    self._link(a, b, special)

    def _double(self, value: Any) -> float | None:
        """Return the multiple real root at a critical value; None if a root goes to infinity."""
        with mp.workdps(40):
            c = [
                mp.mpf(str(sy.N(a.subs(P, sy.Float(str(value), 40)), 40)))
                for a in sy.Poly(self.gx.as_expr(), X).all_coeffs()
            ]
            while c and abs(c[0]) < mp.mpf(10) ** -20:
                c = c[1:]
            if len(c) < 2:
                return None
            found = mp.polyroots(c, maxsteps=300, extraprec=200, error=False)
            scale = sum(abs(float(a)) for a in self.g.coeffs())
            hits = []
            for r in found:
                if abs(mp.im(r)) < mp.mpf(10) ** -10:
                    x = mp.re(r)
                    size = abs(
                        mp.mpf(str(self.g.eval({X: sy.Float(str(x), 40), P: sy.Float(str(value), 40)})))
                    )
                    if size < mp.mpf(10) ** -18 * scale * (1 + abs(x)) ** 4:
                        hits.append(float(x))
            hits = [x for i, x in enumerate(hits) if all(abs(x - y) > 1e-6 for y in hits[:i])]
            if len(hits) > 1:
                raise Unsuitable("two multiple roots at one value")
            return hits[0] if hits else None

    def _link(self, a: tuple[int, int], b: tuple[int, int], special: Special | None) -> None:
        self.links.setdefault(a, []).append((b, special))
        self.links.setdefault(b, []).append((a, special))

    def connected(self, arc: tuple[int, int]) -> tuple[set[tuple[int, int]], set[Special]]:
        """Return the arcs and special points that are connected to an arc."""
        known, todo, specials = {arc}, [arc], set()
        while todo:
            for other, special in self.links.get(todo.pop(), []):
                if special is not None:
                    specials.add(special)
                if other not in known:
                    known.add(other)
                    todo.append(other)
        return known, specials


def unimodular(rng: np.random.Generator, n: int) -> np.ndarray:
    """Draw an integer matrix with determinant one."""
    matrix = np.eye(n, dtype=int)
    for _ in range(3):
        i, j = rng.choice(n, 2, replace=False)
        matrix[i] += int(rng.integers(-2, 3)) * matrix[j]
    return matrix


def polynomial(rng: np.random.Generator, variables: list[Any], degree: int) -> Any:
    """Draw a sparse polynomial with small integer coefficients."""
    terms = [sy.Integer(int(rng.integers(-3, 4)))]
    for _ in range(4):
        powers = rng.integers(0, degree + 1, len(variables))
        if powers.sum() <= degree:
            terms.append(int(rng.integers(-3, 4)) * sy.prod(v ** int(k) for v, k in zip(variables, powers)))
    return sum(terms)


def curve(rng: np.random.Generator) -> Any:
    """Draw g(x, p): one polynomial, or a product of two."""
    if rng.random() < 0.6:
        first = polynomial(rng, [X, P], 2)
        second = X - int(rng.integers(-1, 2)) if rng.random() < 0.5 else polynomial(rng, [X, P], 2)
        return sy.expand(first * second)
    return polynomial(rng, [X, P], 4)


class System:
    """A random system of equations that contains the plane curve.

    Raises
    ------
    Unsuitable
        If its structure is not determined exactly.
    """

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        g = curve(rng)
        if not (g.has(X) and g.has(P)) or sy.degree(g, X) < 1:
            raise Unsuitable("no curve")
        with mp.workdps(15):  # fixed precision, so that starts are always the same to the last bit
            self.curve = Curve(g)
        places = [(k, i) for k, (_, roots) in enumerate(self.curve.middles) for i in range(len(roots))]
        if not places:
            raise Unsuitable("no real root")
        self.start = places[int(rng.integers(len(places)))]
        self.n = n = int(rng.integers(1, 4))
        hidden = [X, Y, Z][:n]
        self.graphs = [polynomial(rng, [X, P], 2), polynomial(rng, [X, Y, P], 2)][: n - 1]
        # add multiples of the other equations, so that the first row depends on all unknowns
        more = sum((v - q) * polynomial(rng, [X, P], 1) for v, q in zip(hidden[1:], self.graphs))
        rows = [g + more, *(v - q for v, q in zip(hidden[1:], self.graphs))]
        self.columns, self.rows = (
            unimodular(rng, n) if n > 1 else np.eye(1),
            unimodular(rng, n) if n > 1 else np.eye(1),
        )
        self.back = np.rint(np.linalg.inv(self.columns))
        self.f = sy.lambdify([hidden, P], rows, "numpy")
        self.unresolved: list[Any] = []
        self.others = [sy.lambdify([hidden[: k + 1], P], q, "numpy") for k, q in enumerate(self.graphs)]

    def F(self, u: np.ndarray, p: Any) -> np.ndarray:
        """Return the residuals, as a function for contvines."""
        return self.rows @ np.array(self.f(self.back @ u, p))

    def unknowns(self, x: float, p: float) -> np.ndarray:
        """Return the unknowns u of a point on the curve."""
        hidden = [x]
        for other in self.others:
            hidden.append(float(other(hidden, p)))
        return self.columns @ np.array(hidden)

    def wrong(self) -> list[str]:
        """Return errors of the diagram: missing and additional solutions and special points."""
        k, i = self.start
        p0, roots = self.curve.middles[k]
        problem = cv.AlgebraicProblem(self.F, self.unknowns(roots[i], p0), p0)
        graph = cv.diagram(problem, within=(LOW, HIGH), depth=12)
        self.unresolved = [x for x in graph.unresolved if x.high - x.low > WIDE]
        arcs, specials = self.curve.connected(self.start)
        said = []
        found = [
            (s.kind, s.value, float((self.back @ s.u)[0])) for s in graph.special.values() if s.kind != "end"
        ]
        for s in specials:
            if not any(
                kind == s.kind and abs(p - s.value) < 1e-8 and abs(x - s.x) < 1e-5 for kind, p, x in found
            ):
                said.append(f"lacks {s}")
        for kind, p, x in found:
            if not any(kind == s.kind and abs(p - s.value) < 1e-8 and abs(x - s.x) < 1e-5 for s in specials):
                said.append(f"has {kind} at p = {p}, x = {x}")
        for j, (p, roots) in enumerate(self.curve.middles):
            crossed = []
            for branch in graph:
                gaps = branch.values - p
                for m in np.flatnonzero(gaps[:-1] * gaps[1:] <= 0.0):
                    t = gaps[m] / (gaps[m] - gaps[m + 1]) if gaps[m] != gaps[m + 1] else 0.0
                    crossed.append(
                        float((self.back @ ((1 - t) * branch.points[m] + t * branch.points[m + 1]))[0])
                    )
            wanted = [x for m, x in enumerate(roots) if (j, m) in arcs]
            low, high = self.curve.ends[j], self.curve.ends[j + 1]
            for x in wanted:
                if self.beyond(problem, graph, x, p, (float(low), float(high))):
                    continue
                if not any(abs(x - y) < 0.02 * (1.0 + abs(x)) for y in crossed):
                    said.append(f"lacks the arc at p = {p}, x = {x}")
            for y in crossed:
                if not any(abs(x - y) < 0.02 * (1.0 + abs(x)) for x in wanted):
                    said.append(f"has an arc at p = {p}, x = {y}")
        return said

    def beyond(self, problem: Any, graph: Any, x: float, p: float, arc: tuple[float, float]) -> bool:
        """Whether a point on an arc towards a pole lies beyond `escape`, and a branch on this arc has ended with this reason."""
        distance = (self.unknowns(x, p) - problem.u0) / problem.scales.unknowns
        far = np.sqrt((distance**2).mean()) > graph.settings["escape"]
        ends = [end for branch in graph for end in branch.endings if end.reason is Reason.ESCAPED]
        return bool(far) and any(arc[0] < end.value < arc[1] for end in ends)


def suitable(first: int) -> Any:
    """Yield seeds and systems, without unsuitable ones."""
    seed = first
    while True:
        with contextlib.suppress(Unsuitable):
            yield seed, System(seed)
        seed += 1


def main(count: int, first: int) -> None:
    """Check `count` systems and print the findings."""
    began, bad, unresolved = time.process_time(), 0, 0
    for done, (seed, system) in enumerate(suitable(first)):
        if done == count:
            break
        try:
            said = system.wrong()
        except (ValueError, ArithmeticError, AssertionError) as error:
            said = [f"{type(error).__name__}: {error}"]
        unresolved += bool(system.unresolved)
        if said:
            bad += 1
            print(
                seed,
                system.n,
                system.curve.g.as_expr(),
                "from",
                system.start,
                *said,
                sep="\n    ",
                flush=True,
            )
    print(
        f"{count} systems, {bad} wrong, {unresolved} with unresolved intervals, {time.process_time() - began:.0f} s",
        flush=True,
    )


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
