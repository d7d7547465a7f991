"""Pieces: piecewise smooth equations whose form is selected by the signs of switches.

A piece is a set of signs: for every node (a map's cycle has several) one sign for every switch. Inside the piece each switch times its
sign is positive: these products are the margins of the problem, and the branch meets a border where one of them vanishes. On the other
side this sign is reversed. The tangents of both sides determine the type of the border:

persistence        the branch continues in the adjacent piece;
nonsmooth fold     both pieces have their solutions on the same side of the parameter;
nonsmooth flip     (maps) a cycle of twice the length, with the sign reversed in one of its halves, is born at the border.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from inspect import signature
from typing import TYPE_CHECKING, Protocol

import numpy as np

from contvines.shared.near_names import did_you_mean

from .functions import NotEvaluable, ParameterSet, UserFunction
from .protocol import Problem, Seed, margin_of
from .settings import IDENTITY

if TYPE_CHECKING:
    from .protocol import BorderPoint


class Pieced(Problem, Protocol):
    """A problem whose equations have pieces."""

    def margins(self, u: np.ndarray, p: float) -> np.ndarray: ...
    def with_pieces(self, pieces: Pieces) -> Pieced: ...


class UnknownSwitch(KeyError):
    """There is no switch of the requested name."""

    def __str__(self) -> str:
        return str(self.args[0])


class Signs(dict[str, int]):
    """Third argument of the user's function: +1 or -1 by the name of a switch."""

    def __missing__(self, name: str) -> int:
        hint = did_you_mean(str(name), self)
        raise UnknownSwitch(f"there is no switch {name!r}{hint}; the problem has {', '.join(self)}")


def _takes_signs(call: Callable) -> bool:
    """Whether a function can be called with three arguments; True if its signature is unknown."""
    try:
        signature(call).bind(None, None, None)
    except TypeError:
        return False
    except ValueError:
        return True
    return True


class Pieces:
    """Switches and the signs that select a piece.

    Parameters
    ----------
    switches : mapping of str to callable, or None
        (u, p) -> number.
    parameters : ParameterSet
    nodes : ndarray, shape (m, d)
        States at which the initial signs are taken.

    Raises
    ------
    ValueError
        If a switch is no function, or cannot be evaluated at a node, or is no finite number there.
    """

    def __init__(
        self, switches: Mapping[str, Callable] | None, parameters: ParameterSet, nodes: np.ndarray
    ) -> None:
        for name, switch in (switches or {}).items():
            if not (isinstance(name, str) and callable(switch)):
                raise ValueError(f"switches: {name!r} must be a name with a function (u, p) -> number")
        self.given, self.parameters = dict(switches or {}), parameters
        self.switches = [UserFunction(f, f"the switch {name}", parameters) for name, f in self.given.items()]
        try:
            values = np.array([self._switch_values(node, parameters.start) for node in nodes])
        except NotEvaluable as error:
            raise ValueError(f"{error}, at the start") from error
        for name, column in zip(self.given, values.T):
            if not np.isfinite(column).all():
                raise ValueError(
                    f"the switch {name} is {column[0]:g} at the start: it must be a finite number there"
                )
        self.signs = np.where(values >= 0.0, 1, -1).reshape(len(nodes), len(self.switches))
        self.current = 0

    def _switch_values(self, u: np.ndarray, p: float) -> np.ndarray:
        return np.array([float(switch(u, p)[0]) for switch in self.switches])

    def choose(self, u: np.ndarray, p: float) -> None:
        """Set the signs to those at one state (for a single node)."""
        self.signs = np.where(self._switch_values(u, p) >= 0.0, 1, -1).reshape(1, -1)
        self.current = 0

    @property
    def count(self) -> int:
        """Number of margins."""
        return self.signs.size

    @property
    def key(self) -> tuple[int, ...]:
        """The signs, hashable."""
        return tuple(int(sign) for sign in self.signs.reshape(-1))

    @property
    def word(self) -> str:
        """The signs as text: a group for each node, ``+-|--``."""
        return "|".join("".join("+" if sign > 0 else "-" for sign in node) for node in self.signs)

    def wrap(self, f: Callable, name: str = "F") -> Callable:
        """Wrap a function (u, p, sign) as one of (u, p), with the signs of the current node.

        Raises
        ------
        ValueError
            If the function cannot be called with the signs; `name` is for the message.
        """
        if not self.switches:
            return f
        if not _takes_signs(f):
            raise ValueError(
                f"{name} cannot be called as {name}(u, p, sign): with switches= it must take a third argument, a mapping from "
                f"their names ({', '.join(self.given)}) to +1 or -1"
            )
        return lambda u, p: f(u, p, self._current_signs())

    def _current_signs(self) -> dict[str, int]:
        return Signs(zip(self.given, (int(sign) for sign in self.signs[self.current])))

    def margins(self, nodes: np.ndarray, p: float) -> np.ndarray:
        """Return the switches times their signs, flat; NaN if a switch cannot be evaluated."""
        try:
            values = np.array([self._switch_values(node, p) for node in nodes])
        except NotEvaluable:
            return np.full(self.count, np.nan)
        return (values * self.signs).reshape(-1)

    def turned(self, j: int, copies: int = 1) -> Pieces:
        """Return the pieces with the sign of margin j reversed, followed by `copies` - 1 more cycles with unchanged signs."""
        other = copy(self)
        signs = [self.signs.copy() for _ in range(copies)]
        signs[0].reshape(-1)[j] *= -1
        other.signs = np.concatenate(signs)
        return other

    def against(self, parameters: ParameterSet) -> Pieces:
        """Return the same signs, with switches that read other parameters."""
        other = copy(self)
        other.parameters = parameters
        other.switches = [UserFunction(s.f, s.name, parameters) for s in self.switches]
        return other

    def repeated(self, times: int, count: int | None = None) -> Pieces:
        """Return the signs repeated for several cycles in a row; ``count``: only those of the first nodes."""
        other = copy(self)
        other.signs = np.tile(self.signs[:count], (times, 1))
        return other

    def beyond(self, problem: Pieced, point: BorderPoint) -> list[Seed]:
        """Return the branches that leave a border: in the adjacent piece, and for maps the cycle of twice the length.

        Parameters
        ----------
        problem : AlgebraicProblem or MapProblem
        point : SpecialPoint
            Its tangent points out of the current piece.
        """
        j, seeds = margin_of(point), []
        candidates: list[tuple[Pieced, np.ndarray, bool]] = [
            (problem.with_pieces(self.turned(j)), point.u, False)
        ]
        if problem.spectrum == "map":
            candidates.append((problem.with_pieces(self.turned(j, 2)), np.tile(point.u, 2), True))
        for other, u, flip in candidates:
            tangent = _inward(other, u, point.value, j)
            if tangent is None:
                continue
            persistence = bool(tangent[-1] * point.tangent[-1] > 0.0)
            if flip:
                note = "nonsmooth flip"
            else:
                note = "persistence" if persistence else "nonsmooth fold"
            seeds.append(Seed(other, u, point.value, tangent, "border", note, persistence and not flip))
        return seeds


def _inward(problem: Pieced, u: np.ndarray, p: float, j: int) -> np.ndarray | None:
    """The tangent at a border point along which margin j grows, and all margins that vanish with it; None if there is none."""
    n = problem.dimension
    work, step, tangent = problem.workspace(), np.zeros(n + 1), np.zeros(n + 1)
    u = np.ascontiguousarray(u, dtype=float)
    if not problem.kernels.linearise(problem, u, p, work) < np.inf:
        return None
    border = np.random.default_rng(6).uniform(0.5, 1.0, n + 1)
    problem.kernels.bordered(problem, work, border, 0.0, step, tangent)
    if not np.isfinite(tangent).all() or not tangent.any():
        return None
    size = float(np.abs(tangent).max())
    unit = 1.0 if problem.scales is None else float(problem.scales.unknowns.max())
    h = IDENTITY.step * max(unit, float(np.abs(np.append(u, p)).max())) / size
    ahead, back = (problem.margins(u + s * h * tangent[:-1], p + s * h * tangent[-1]) for s in (1.0, -1.0))
    growth = ahead - back
    if not abs(growth[j]) > 0.0:
        return None
    side = np.sign(growth[j])
    vanishing = np.abs(ahead + back) <= IDENTITY.vanishes * np.abs(
        growth
    )  # in a doubled cycle one margin of each half vanishes
    return side * tangent if (side * growth[vanishing] > 0.0).all() else None
