"""Branch: an ordered family of solutions of one problem; Ending: the reason why a branch ends, as data from which the sentence is made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kinds import BORDERS
from ..continuation.layout import Status
from ..continuation.settings import hinted
from ..problems.abilities import Limited, Provable
from ..problems.registry import without_problem
from ..shared.numbers import number_text

if TYPE_CHECKING:
    from ..flows.measures import MeasuresWithoutRates
    from ..problems.protocol import BorderPoint, Problem


class Reason(StrEnum):
    """Reason why a branch ends; the first ones are those of the continuation loop (:class:`contvines.continuation.layout.Status`)."""

    RUNNING = "running"
    LEFT_INTERVAL = "left-interval"
    STEP_TOO_SMALL = "step-too-small"
    NOT_EVALUABLE = "not-evaluable"
    BORDER = "border"
    MAX_POINTS = "max-points"
    CLOSED = "closed"
    ESCAPED = "escaped"
    CREEPING = "creeping"
    COARSE = "coarse"
    LEAVES = "leaves"  # begins at a special point of another branch
    GOES_ON = "goes-on"  # continues another branch beyond its border, with the same equations
    REACHES = "reaches"  # ends at a special point of its own
    MEETS = "meets"  # ends at a special point of another branch
    MEETS_SYMMETRIC = "meets-symmetric"  # ends at a special point of a branch of more symmetric solutions
    COMES_BACK = "comes-back"  # the same, if that branch has not been traced
    STOPS = "stops"  # ends at a zero of a user function
    SAID = "said"  # only a sentence is known


@dataclass(frozen=True)
class Ending:
    """One end of a branch.

    Attributes
    ----------
    reason : Reason
    value : float
        Parameter value at the end.
    point : str or None
        Label of the special point at the end.
    other : str or None
        Label of the other branch: the one that this branch leaves, continues or meets.
    kind : str or None
        Kind of the special point as located on this branch.
    text : str
        The problem's explanation, or the name of the user function. For SAID the whole sentence: from a file of version 0.1, or for a family
        of solutions that is no branch.
    """

    reason: Reason
    value: float = float("nan")
    point: str | None = None
    other: str | None = None
    kind: str | None = None
    text: str = ""

    @classmethod
    def of(cls, status: Status, value: float) -> Ending:
        """Return the ending for a status of the continuation loop."""
        return cls(Reason[status.name], float(value))

    @classmethod
    def from_text(cls, text: str) -> Ending:
        """Return an ending that is only a sentence."""
        return cls(Reason.SAID, text=text)

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> Ending:
        """Rebuild an ending from the result of `to_dict`."""
        return cls(**{**content, "reason": Reason(content["reason"])})

    def to_dict(self) -> dict[str, Any]:
        """Return the ending as a dict of JSON scalars."""
        return {**asdict(self), "reason": self.reason.value}

    def sentence(self, parameter: str, unit: float = 1.0) -> str:
        """Return the ending as a sentence; ``unit`` is the typical size of the parameter, relative to which rounding is shown as zero."""
        at = f"{parameter} = {number_text(self.value, 10, unit)}"
        match self.reason:
            case Reason.SAID:
                return self.text
            case Reason.LEAVES:
                return f"leaves {self.other} at {self.point}"
            case Reason.GOES_ON:
                return f"goes on from {self.other} at {self.point}"
            case Reason.REACHES:
                return f"reaches {self.point} ({self.kind}) at {at}"
            case Reason.STOPS:
                return f"stops at {self.point} ({self.text}), {at}"
            case Reason.MEETS:
                return f"meets {self.other} at {self.point} ({self.kind}), {at}"
            case Reason.MEETS_SYMMETRIC:
                return f"meets {self.other} at {self.point}, {at}"
            case Reason.COMES_BACK:
                return f"comes back to more symmetric solutions at {self.point}, {at}"
        reason = Status[self.reason.name].sentence(parameter, self.value, unit)
        return f"{reason}; {self.text}" if self.text else reason


@hinted
@dataclass(eq=False)
class Branch:
    """A branch of solutions, in order along the curve, special points included.

    Attributes
    ----------
    label : str
    problem : Problem or None
        None after loading a graph whose problem came from a Python callable.
    points : ndarray, shape (n, N)
        Unknowns.
    values : ndarray, shape (n,)
        Parameter values.
    tangents : ndarray, shape (n, N + 1)
        Unit tangents (in the metric of the continuation), all pointing forward along the stored order.
    multipliers : ndarray of complex, shape (n, m)
        Multipliers of the full period (eigenvalues for flows).
    margin : ndarray, shape (n,)
        Smallest margin, +inf for a problem without margins.
    stable : ndarray of bool, shape (n,), or None
        A special point counts as stable if one of its neighbours is. None if stability is not computed, as for a problem
        with ``spectrum="none"``.
    real : bool
        False for a virtual branch: it lies beyond a border, and no machine can follow it.
    endings : (Ending, Ending)
        Reasons why the branch ends, at its first and at its last point; as sentences in ``ended``.
    closed : bool
        True if the last point is the first one again (modulo the shift by a period).
    seed : str or None
        Label of the special point from which the branch was reached.
    marks : tuple of (int, str)
        Index and label of each special point on the branch, in order.
    description : dict
        Result of ``problem.describe()``.
    parameter : str
        Name of the continuation parameter.
    """

    label: str
    problem: Problem | None = field(repr=False)
    points: np.ndarray = field(repr=False)
    values: np.ndarray = field(repr=False)
    tangents: np.ndarray = field(repr=False)
    multipliers: np.ndarray = field(repr=False)
    margin: np.ndarray = field(repr=False)
    stable: np.ndarray | None = field(repr=False)
    real: bool = True
    endings: tuple[Ending, Ending] = (Ending.from_text(""), Ending.from_text(""))
    closed: bool = False
    seed: str | None = None
    marks: tuple[tuple[int, str], ...] = ()
    description: dict[str, Any] = field(default_factory=dict, repr=False)
    parameter: str = "p"

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        lo, hi = self.range
        return f"Branch({self.label}: {len(self)} points, {self.parameter} in [{lo:.6g}, {hi:.6g}])"

    def _repr_html_(self) -> str:
        from ..graph.table import branch_page

        return branch_page(self)

    def to_pandas(self):
        """Return the points as a data frame; see :func:`contvines.export.frames.branch_frame`."""
        from ..export.frames import branch_frame

        return branch_frame(self)

    def to_xarray(self):
        """Return the branch as a data set; see :func:`contvines.export.frames.branch_dataset`."""
        from ..export.frames import branch_dataset

        return branch_dataset(self)

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest parameter value."""
        return float(np.min(self.values)), float(np.max(self.values))

    @property
    def ended(self) -> tuple[str, str]:
        """Reasons why the branch ends, at its first and at its last point, as sentences."""
        unit = float(np.abs(self.values).max(initial=0.0))
        first, last = (ending.sentence(self.parameter, unit) for ending in self.endings)
        return first, last

    def pieces(self) -> list[tuple[int, int, bool | None]]:
        """Return the runs of equal stability as (first, last, stable), with inclusive indices; neighbouring runs share a point.

        If stability is not computed, there is one run with ``stable`` None.
        """
        n = len(self)
        if self.stable is None or n < 2:
            return [(0, n - 1, None if self.stable is None else bool(self.stable[0]))] if n else []
        segment = self.stable[:-1] & self.stable[1:]  # segment i joins point i to point i + 1
        breaks = np.flatnonzero(segment[1:] != segment[:-1]) + 1
        starts = [0, *breaks.tolist()]
        stops = [*breaks.tolist(), n - 1]
        return [(a, b, bool(segment[a])) for a, b in zip(starts, stops, strict=True)]

    def stable_intervals(self) -> list[tuple[float, float]]:
        """Return the parameter intervals of the stable pieces, in increasing order.

        On a closed branch a stable piece through the first point gives one interval.
        """
        pieces = self.pieces()
        parts = [self.values[first : last + 1] for first, last, stable in pieces if stable]
        if self.closed and len(pieces) > 1 and pieces[0][2] and pieces[-1][2]:
            parts[0] = np.concatenate([parts.pop(), parts[0]])
        return sorted((float(part.min()), float(part.max())) for part in parts)

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Names of measures, apart from the parameter.

        Without a problem: ``norm``, or for flows the measures that need no right-hand side.
        """
        bare = self._bare
        names = ("norm",) if bare is None else bare.names
        names = names if self.problem is None else self.problem.measure_names
        return tuple(str(name) for name in names if name != self.parameter)

    def measure(self, name: str) -> np.ndarray:
        """Return a measure along the branch, shape (n,); its name is one of `measure_names` or the parameter's name.

        Raises
        ------
        KeyError
            If the problem has no such measure.
        """
        # results are stored: pictures and surveys need the same measure many times
        computed = vars(self).setdefault("_measured", {})
        points, values, found = computed.get(name, (None, None, None))
        if points is not self.points or values is not self.values:
            found = self.measure_of(name, self.points, self.values)
            computed[name] = self.points, self.values, found
        return np.array(found)

    def measure_of(self, name: str, u: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Return a measure of other solutions of this branch's problem.

        Parameters
        ----------
        name : str
        u : ndarray, shape (m, N)
        p : ndarray, shape (m,)

        Returns
        -------
        ndarray, shape (m,)

        Raises
        ------
        KeyError
            If there is no such measure.
        """
        if name == self.parameter:
            return np.asarray(p, dtype=float)
        if self.problem is None:
            bare = self._bare
            if bare is not None and name in bare.names:
                return bare(name, u)
            return _bare_measure(self.label, name, u)
        return self.problem.measures((name,), u, p)[name]

    @property
    def default_measure(self) -> str:
        """Name of the measure that pictures show by default; empty if the problem is not known."""
        if self.problem is not None:
            return self.problem.default_measure
        return "" if self._bare is None else f"max {self._bare.states[0]}"

    @property
    def _bare(self) -> MeasuresWithoutRates | None:
        """Measures of a flow that was loaded without its problem; None for other branches."""
        if self.problem is not None or "flow" not in self.description:
            return None
        from ..flows.measures import measures_without_rates  # not needed for machines

        return measures_without_rates(self.description, self.points.shape[1])

    @property
    def attached(self) -> Problem:
        """The problem of the branch.

        Raises
        ------
        ValueError
            If there is none, as after loading a graph of Python callables.
        """
        if self.problem is None:
            raise ValueError(without_problem(self.label, self.description))
        return self.problem

    def orbit(self, i: int) -> Any:
        """Return the solution at point i as the problem's object for users, for example an orbit; at a border with the multipliers' limits.

        Raises
        ------
        TypeError, IndexError
            If `i` is not the number of a point.
        ValueError
            If the branch has no problem.
        """
        n = len(self)
        if not isinstance(i, int | np.integer):
            raise TypeError(f"{self.label}.orbit({i!r}): give the number of a point, from 0 to {n - 1}")
        if not -n <= i < n:
            raise IndexError(f"{self.label} has no point {i}; its {n} points are numbered from 0 to {n - 1}")
        found = self.attached.orbit(self.points[i], float(self.values[i]))
        ends = {0: self.endings[0], n - 1: self.endings[1]}
        if i % n in ends and ends[i % n].kind in BORDERS and isinstance(found, Limited):
            return found.with_multipliers(self.multipliers[i])
        return found

    def prove(
        self,
        within: tuple[float, float] | None = None,
        bits: int | None = None,
        special: Mapping[str, BorderPoint] | None = None,
    ) -> object:
        """Prove the branch between its special points, or the part of it ``within`` an interval of the parameter.

        Parameters
        ----------
        within : (float, float), optional
            Interval of the parameter; the whole branch by default.
        bits : int, optional
            Precision of the stretches.
        special : dict, optional
            The graph's special points by label; the proved stretches then extend to the points themselves.

        Raises
        ------
        ValueError
            If the problem has no proofs.
        """
        if not isinstance(self.problem, Provable):
            raise ValueError(
                f"{self.label}: its problem offers no proofs of branches; machines of orbits with flights in closed form do"
            )
        points = {i: special[label] for i, label in self.marks if special and label in special}
        marks = [i for i, _ in self.marks]
        return self.problem.prove_branch(self.points, self.values, marks, within, points, bits)

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of this branch in the JSON of a graph."""
        data = self.description
        return {
            "label": self.label,
            "word": data.get("word"),
            "periods": data.get("periods"),
            "impacts": data.get("impacts"),
            "symmetric": data.get("symmetric"),
            "real": bool(self.real),
            "range": list(self.range),
            "points": len(self),
            "stable": None
            if self.stable is None
            else [list(interval) for interval in self.stable_intervals()],
            "ended": list(self.ended),
            "closed": bool(self.closed),
            "seed": self.seed,
        }


def _bare_measure(label: str, name: str, u: np.ndarray) -> np.ndarray:
    """Return ``norm``, or an unknown as ``u0``, ``u1`` ..., of solutions without a problem."""
    if name == "norm":
        return np.linalg.norm(u, axis=1)
    if name.startswith("u") and name[1:].isdigit() and int(name[1:]) < u.shape[1]:
        return u[:, int(name[1:])]
    raise KeyError(
        f"{label} was loaded without its problem; only norm and u0, u1 ... can be measured, not {name!r}"
    )
