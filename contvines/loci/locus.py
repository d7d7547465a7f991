"""Locus: the special points of one kind in the plane of two parameters; PlanePoint: a point of codimension two on it, with its evidence."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import critical
from ..branches.branch import Branch
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
    value : (float, float)
    u : ndarray, shape (N,)
        The motion, in the unknowns of ``problem``.
    on : list of str
        Labels of the loci on which it lies.
    coefficients : dict
        Of its normal form; see :mod:`contvines.bifurcation.normal_forms.coefficients`.
    multipliers : ndarray of complex
        Of the full period.
    real : bool
    error : float
        Of both values, relative: the last correction of Newton's method, of cycles on a mesh also what the mesh leaves.
    residual : float
    margins : tuple of int
        Places of the margins that vanish there.
    note : str
    problem : Problem or None
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
        """The problem.

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
        """The motion as the object that its problem hands to users; see :attr:`contvines.SpecialPoint.orbit`."""
        return critical(self.attached.orbit(self.u, self.value[0]), self.kind)

    def to_dict(self) -> dict[str, Any]:
        """The entry of this point in the JSON of a chart."""
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
    """A point at which the locus turns round in the second parameter."""

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
        Of the special points.
    parameters : (str, str)
        The parameter of the diagram and the second one.
    branch : Branch
        The locus as a branch against the second parameter: ``points`` are (u, p), ``values`` those of the second parameter.
    real : ndarray of bool, shape (n,)
        False beyond a border, where no machine follows the motion.
    seed : str or None
        Label of the special point from which it was started.
    marks : tuple of (int, str)
        Index (of the point before it) and label of each point of codimension two on it.
    points : dict of PlanePoint
        The same points by label. Marks and points are sought when one of them is first asked for; a chart has sought them already.
    turns : tuple of Turn
        Where it turns round in the second parameter.
    within : (float, float)
        Interval of the second parameter.
    kinds : tuple of Kind
        The user's own: zeros of their tests along the locus are points, too.
    beyond : int
        Of a border: on which side of it, looking along the points with q to the right and p upwards, the motion cannot be: 1
        left, -1 right, 0 not known.
    limit : {"", "homoclinic", "heteroclinic", "saddle-node", "at-rest"}
        Of cycles of a long period: what they become, where the locus begins, as the period grows without bound.
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
        """As tables and pictures name it: its kind, or what its cycles of a long period become."""
        return self.limit or self.kind

    @property
    def problem(self) -> LocusProblem | None:
        """None after loading without the problem."""
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

    def _marked(self) -> tuple[tuple[int, PlanePoint], ...]:
        if self.marked is None:
            if self.problem is None:
                raise ValueError(
                    f"{self.label} was loaded without its problem; its points of codimension two cannot be sought"
                )
            from .codimension_two import mark_locus

            self.marked = mark_locus(self)
        return self.marked

    @property
    def ended(self) -> tuple[str, str]:
        """Why the locus ends, at its first and at its last point."""
        return self.branch.ended

    @property
    def closed(self) -> bool:
        """Whether the last point is the first one again."""
        return self.branch.closed

    def orbit(self, i: int) -> object:
        """The special solution at point i as the object that the problem hands to users."""
        return self.branch.orbit(i)

    def at(self, value: float) -> np.ndarray:
        """Values of the first parameter where the second one has a value, solved to roundoff.

        Parameters
        ----------
        value : float
            Of the second parameter.

        Returns
        -------
        ndarray, shape (k,)
            In increasing order; empty where the locus does not pass this value.

        Raises
        ------
        ValueError
            If the locus was loaded without its problem.
        """
        branch, q = self.branch, self.branch.values
        if self.problem is None:
            raise ValueError(f"{self.label} was loaded without its problem; nothing can be solved on it")
        low, high = float(min(q.min(), value)), float(max(q.max(), value))
        wide = high - low or 1.0 + abs(high)
        engine = Engine(self.problem, (low - wide, high + wide), Settings())
        crossed = np.flatnonzero((q[:-1] - value) * (q[1:] - value) <= 0.0)
        points = [on_segment(engine, branch, int(i), value) for i in crossed]
        found = np.sort([float(self.problem.split(point.u)[1]) for point in points if point is not None])
        apart = np.diff(found, prepend=-np.inf) > PLACES.same * (1.0 + np.abs(found))
        return found[apart]

    def to_dict(self) -> dict[str, Any]:
        """The entry of this locus in the JSON of a chart."""
        about = self.branch.description
        return {
            "label": self.label,
            "kind": self.kind,
            **({"limit": self.limit} if self.limit else {}),
            "word": about.get("word"),
            "periods": about.get("periods"),
            "seed": self.seed,
            "values": self.values.tolist(),
            "real": [bool(r) for r in self.real],
            "ended": list(self.ended),
            "closed": bool(self.closed),
            "points": [label for _, label in self.marks],
        }
