"""Locus: a curve of special points of one kind in the plane of two parameters; PlanePoint: a point of codimension two on it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import BY_NAME, critical
from ..branches import Branch
from ..branches.solutions import on_segment
from ..continuation.engine import Engine
from ..continuation.settings import Settings, hinted
from ..shared.numbers import pairs
from .problem import LocusProblem
from .settings import PLACES

if TYPE_CHECKING:
    from ..problems.protocol import Problem


@dataclass(eq=False)
class PlanePoint:
    """A point of codimension two.

    Attributes
    ----------
    label, kind : str
    parameters : (str, str)
        Names of the first and the second parameter.
    value : (float, float)
        Their values.
    u : ndarray, shape (N,)
        The motion, as unknowns of ``problem``.
    on : list of str
        Labels of the loci on which the point lies.
    coefficients : dict
        Coefficients of its normal form; see :mod:`contvines.bifurcation.normal_forms.coefficients`.
    multipliers : ndarray of complex
        Multipliers over the full period.
    real : bool
        Whether all margins of the motion are positive or zero.
    error : float
        Relative error of both values: the last correction of Newton's method, and for cycles also the error of the mesh.
    residual : float
        Largest residual of the equations.
    margins : tuple of int
        Indices of the margins that vanish at the point.
    note : str
    problem : Problem or None
        None if the point was loaded without it.
    """

    label: str
    kind: str
    parameters: tuple[str, str]
    value: tuple[float, float]
    u: np.ndarray = field(repr=False)
    on: list[str] = field(default_factory=list)
    coefficients: dict[str, float] = field(default_factory=dict)
    multipliers: np.ndarray = field(default_factory=lambda: np.zeros(0, complex), repr=False)
    real: bool = True
    error: float = 0.0
    residual: float = 0.0
    margins: tuple[int, ...] = ()
    note: str = ""
    problem: Problem | None = field(default=None, repr=False)

    @property
    def attached(self) -> Problem:
        """The problem of the motion.

        Raises
        ------
        ValueError
            If the point was loaded without it.
        """
        if self.problem is None:
            raise ValueError(f"{self.label} was loaded without its problem")
        return self.problem

    @property
    def orbit(self) -> object:
        """The motion as an orbit object of its problem; see :attr:`contvines.SpecialPoint.orbit`."""
        return critical(self.attached.orbit(self.u, self.value[0]), self.kind)

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of this point in the JSON of a chart."""
        return {
            "label": self.label,
            "kind": self.kind,
            "value": dict(zip(self.parameters, map(float, self.value))),
            "on": list(self.on),
            "coefficients": {name: float(value) for name, value in self.coefficients.items()},
            "real": bool(self.real),
            "multipliers": pairs(self.multipliers),
            "error": float(self.error),
            "residual": float(self.residual),
            "note": self.note,
        }


@dataclass(frozen=True)
class Turn:
    """A turning point of a locus in the second parameter: index of a point of the locus, and (p, q)."""

    index: int
    value: tuple[float, float]


@hinted
@dataclass(eq=False)
class Locus:
    """A connected curve of special points of one kind in the plane of two parameters.

    Attributes
    ----------
    label : str
    kind : str
        Kind of the special points.
    parameters : (str, str)
        The parameter of the diagram and the second one.
    branch : Branch
        The locus as a branch in the second parameter: ``points`` are (u, p), ``values`` those of the second parameter.
    real : ndarray of bool, shape (n,)
        False beyond a border, where no machine can follow the motion.
    seed : str or None
        Label of the special point from which it was started.
    marks : tuple of (int, str)
        Each point of codimension two on it: index of the locus's point before it, and label.
    points : dict of PlanePoint
        The same points by label. They are computed when marks or points are first accessed; a chart has computed them already.
    turns : tuple of Turn
        Turning points in the second parameter.
    within : (float, float)
        Interval of the second parameter.
    kinds : tuple of Kind
        User-defined kinds; zeros of their tests along the locus are points, too.
    beyond : int
        For a border: the side on which the motion is impossible, seen in the direction of the points with q to the right and p upwards:
        1 left, -1 right, 0 unknown.
    limit : {"", "homoclinic", "heteroclinic", "saddle-node", "at-rest"}
        For cycles of a long period: their limit of infinite period, at the start of the locus.
    """

    label: str
    kind: str
    parameters: tuple[str, str]
    branch: Branch = field(repr=False)
    real: np.ndarray = field(repr=False)
    seed: str | None = None
    turns: tuple[Turn, ...] = ()
    within: tuple[float, float] = (-np.inf, np.inf)
    beyond: int = 0
    marked: tuple[tuple[int, PlanePoint], ...] | None = field(default=None, repr=False)
    kinds: tuple[Kind, ...] = field(default=(), repr=False)
    limit: str = ""

    def __len__(self) -> int:
        return len(self.branch)

    def __repr__(self) -> str:
        p, q = self.parameters
        lo, hi = self.branch.range
        return f"Locus({self.label}: {self.sort}, {len(self)} points, {q} in [{lo:.6g}, {hi:.6g}])"

    @property
    def sort(self) -> str:
        """Name in tables and pictures: the limit of cycles of a long period, else the kind."""
        return self.limit or self.kind

    @property
    def problem(self) -> LocusProblem | None:
        """Problem of the locus; None if it was loaded without it."""
        problem = self.branch.problem
        return problem if isinstance(problem, LocusProblem) else None

    @property
    def size(self) -> int:
        """Number of unknowns of the motion itself."""
        extra = 2 if self.branch.description.get("unfolded") else 1
        return self.branch.points.shape[1] - extra

    @property
    def values(self) -> np.ndarray:
        """(p, q) of the points, shape (n, 2)."""
        unit = self.branch.description.get("unit", 1.0)
        return np.column_stack([unit * self.branch.points[:, self.size], self.branch.values])

    @property
    def marks(self) -> tuple[tuple[int, str], ...]:
        """Index and label of each point of codimension two."""
        return tuple((index, point.label) for index, point in self._marked())

    @property
    def points(self) -> dict[str, PlanePoint]:
        """The points of codimension two, by label."""
        return {point.label: point for _, point in self._marked()}

    @property
    def _bare(self) -> str:
        """Why there is no problem, and for users' kinds the way to it."""
        known = self.kind in BY_NAME
        way = (
            ""
            if known
            else " (files do not keep kinds of your own: contvines.load(..., kinds=[*contvines.KINDS, yours]))"
        )
        return f"{self.label} was loaded without its problem{way}"

    def _marked(self) -> tuple[tuple[int, PlanePoint], ...]:
        if self.marked is None:
            if self.problem is None:
                raise ValueError(f"{self._bare}; its points of codimension two cannot be sought")
            from .codimension_two import mark_locus

            self.marked = mark_locus(self)
        return self.marked

    @property
    def ended(self) -> tuple[str, str]:
        """Reasons why the locus ends at its first and at its last point."""
        return self.branch.ended

    @property
    def closed(self) -> bool:
        """Whether the locus is a closed curve."""
        return self.branch.closed

    def orbit(self, i: int) -> object:
        """Return the motion at point i as an orbit object of the problem."""
        return self.branch.orbit(i)

    def at(self, value: float) -> np.ndarray:
        """Solve for the first parameter at a given value of the second one, to roundoff.

        Parameters
        ----------
        value : float
            Value of the second parameter.

        Returns
        -------
        ndarray, shape (k,)
            Values of the first parameter in increasing order; empty if the locus does not reach `value`.

        Raises
        ------
        ValueError
            If the locus was loaded without its problem.
        """
        branch, q = self.branch, self.branch.values
        if self.problem is None:
            raise ValueError(f"{self._bare}; nothing can be solved on it")
        low, high = float(min(q.min(), value)), float(max(q.max(), value))
        wide = high - low or 1.0 + abs(high)
        engine = Engine(self.problem, (low - wide, high + wide), Settings())
        crossed = np.flatnonzero((q[:-1] - value) * (q[1:] - value) <= 0.0)
        points = [on_segment(engine, branch, int(i), value) for i in crossed]
        found = np.sort([float(self.problem.split(point.u)[1]) for point in points if point is not None])
        distinct = np.diff(found, prepend=-np.inf) > PLACES.same * (1.0 + np.abs(found))
        return found[distinct]

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of this locus in the JSON of a chart."""
        data = self.branch.description
        return {
            "label": self.label,
            "kind": self.kind,
            **({"limit": self.limit} if self.limit else {}),
            "word": data.get("word"),
            "periods": data.get("periods"),
            "seed": self.seed,
            "values": self.values.tolist(),
            "real": [bool(r) for r in self.real],
            "ended": list(self.ended),
            "closed": bool(self.closed),
            "points": [label for _, label in self.marks],
        }
