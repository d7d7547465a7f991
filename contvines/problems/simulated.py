"""Maps and equations of motion made of Python callables, simulated: in the piece in which the state is, not that of a solution."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from .functions import NotEvaluable
from .scales import Scales
from .settings import SIMULATION

if TYPE_CHECKING:
    from collections.abc import Callable

    from .derivatives import Differentiated
    from .pieces import Pieces
    from .populations import Population


class Iterated(Protocol):
    """What is read of the problem of a map's cycles."""

    @property
    def functions(self) -> Differentiated: ...
    @property
    def pieces(self) -> Pieces: ...
    @property
    def node(self) -> int: ...
    @property
    def cycle(self) -> int: ...
    def functions_in(self, pieces: Pieces) -> Differentiated: ...


class MapSection:
    """A map applied once per period of a cycle; see :mod:`contvines.circles.section`.

    Parameters
    ----------
    problem : MapProblem
    p : float
    """

    def __init__(self, problem: Iterated, p: float) -> None:
        self.problem, self.p = problem, float(p)
        self.pieces = problem.pieces.repeated(1, 1)
        self.functions = problem.functions
        if self.pieces.count:
            self.functions = problem.functions_in(self.pieces)

    @property
    def names(self) -> tuple[str, ...]:
        """x0, x1, ..."""
        return tuple(f"x{j}" for j in range(self.problem.node))

    def through(self, u: np.ndarray) -> np.ndarray:
        """The first point of the cycle."""
        return np.array(u[: self.problem.node], dtype=float)

    def rounds(self, u: np.ndarray) -> np.ndarray:
        """All points of the cycle, shape (periods, d)."""
        return np.array(u, dtype=float).reshape(self.problem.cycle, self.problem.node)

    def image(self, x: np.ndarray) -> np.ndarray:
        """f at a point, in the piece in which it lies; NaN where f is not defined."""
        try:
            if self.pieces.count:
                self.pieces.choose(x, self.p)
            with np.errstate(all="ignore"):
                return np.asarray(self.functions.value(x, self.p), dtype=float)
        except NotEvaluable:
            return np.full(self.problem.node, np.nan)

    def step(self, x: np.ndarray) -> np.ndarray:
        """One period of the cycle later."""
        for _ in range(self.problem.cycle):
            x = self.image(x)
        return x


class SimulatedMap:
    """What a MapProblem says of its motions."""

    population: Callable[..., Population]
    cycle: int

    def simulated_attractors(self, p: float, starts: int = 24) -> list[dict[str, Any]]:
        """What starts round the cycle settle on at a parameter value: "word", "periods" and "kind" of each motion."""
        population = self.population()
        motions, _, _ = population.settle(population.starts(starts, 7, p), p)
        found = {(m.word, m.periods, "cycle" if m.word else m.kind) for m in motions}
        return [
            {"word": word or None, "periods": periods, "kind": kind} for word, periods, kind in sorted(found)
        ]

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """A stable cycle as `simulated_attractors` lists it."""
        return {"word": f"{self.cycle}-cycle", "periods": self.cycle, "kind": "cycle"}


class SimulatedFlow:
    """What an AlgebraicProblem says of the motions of u' = F(u, p)."""

    spectrum: str
    node: int
    u0: np.ndarray
    residuals: Callable[[np.ndarray, float], np.ndarray]
    scales: Scales | None

    def simulated_attractors(self, p: float, starts: int = 12) -> list[dict[str, Any]]:
        """What starts round u0 settle on: equilibria, each once, oscillations, or nothing within reach; none without a flow.

        "word" and "kind" are "equilibrium", "oscillation" or "escapes"; an equilibrium has its place, "u".
        """
        if self.spectrum != "flow" or self.node > LARGEST or self.node != len(self.u0):
            return []
        middle = np.asarray(self.u0, dtype=float)
        scales = self.scales
        size = np.maximum(np.abs(middle), 1.0 if scales is None else scales.unknowns)
        generator = np.random.default_rng(7)
        found: list[dict[str, Any]] = []
        for i in range(starts):
            spread = np.zeros(self.node) if i == 0 else generator.uniform(-SPREAD, SPREAD, self.node)
            kind, u = self._settled(middle + spread * size, p, size)
            new = {"word": kind, "periods": 0, "kind": kind}
            if kind == "equilibrium":
                new["u"] = [float(x) for x in u]
            if not any(_one(new, other, size) for other in found):
                found.append(new)
        return sorted(found, key=lambda one: (one["kind"], one.get("u", [])))

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """A stable equilibrium as `simulated_attractors` lists it."""
        place = [float(x) for x in u[: self.node]]
        return {"word": "equilibrium", "periods": 0, "kind": "equilibrium", "u": place}

    def _settled(self, u: np.ndarray, p: float, size: np.ndarray) -> tuple[str, np.ndarray]:
        from scipy.integrate import LSODA

        def rate(t: float, x: np.ndarray) -> np.ndarray:
            try:
                return np.asarray(self.residuals(x, p), dtype=float)
            except (ArithmeticError, ValueError):
                return np.full(len(x), np.nan)

        with np.errstate(all="ignore"):
            if not rate(0.0, u).any():  # at rest to the last bit, stable or not
                u = u + SIMULATION.beside * size * (-1.0) ** np.arange(len(u))
            speed = float((np.abs(rate(0.0, u)) / size).max())
            span = 10.0 / speed if np.isfinite(speed) and speed > 0.0 else 10.0
            tolerances: dict[str, Any] = {"rtol": SIMULATION.relative, "atol": SIMULATION.absolute * size}
            solver = LSODA(rate, 0.0, u, np.inf, **tolerances)
            rest, since = u, 0.0  # where the motion was, and when
            for _ in range(PATIENCE):
                solver.step()
                x = solver.y
                if solver.status == "failed" or not float((np.abs(x) / size).max()) < SIMULATION.far:
                    return "escapes", u
                if float((np.abs(x - rest) / size).max()) > SIMULATION.still:
                    rest, since = x.copy(), solver.t
                elif solver.t - since > span:
                    return "equilibrium", x.copy()
        return "oscillation", u


PATIENCE = 4000  # steps of the integration of one start
SPREAD = 2.0  # of the starts, in sizes of the unknowns
LARGEST = 60  # unknowns of equations that are integrated


def _one(a: dict[str, Any], b: dict[str, Any], size: np.ndarray) -> bool:
    if a["kind"] != b["kind"]:
        return False
    return "u" not in a or bool((np.abs(np.subtract(a["u"], b["u"])) < SIMULATION.beside * size).all())
