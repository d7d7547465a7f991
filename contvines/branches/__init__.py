"""Branch: an ordered family of solutions of one problem; and why it ends, as data, of which the sentence is made last."""

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
    """Why a branch ends; the first ones are those of the continuation loop (:class:`contvines.continuation.layout.Status`)."""

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
    LEAVES = "leaves"
    GOES_ON = "goes-on"
    REACHES = "reaches"
    MEETS = "meets"
    MEETS_SYMMETRIC = "meets-symmetric"
    COMES_BACK = "comes-back"
    STOPS = "stops"
    SAID = "said"


@dataclass(frozen=True)
class Ending:
    """One end of a branch.

    Attributes
    ----------
    reason : Reason
    value : float
        Parameter value there.
    point : str or None
        Label of the special point there.
    other : str or None
        Label of the other branch: the one that is left, gone on from or met.
    kind : str or None
        Kind of the special point as this branch sees it.
    text : str
        What the problem says of it; for SAID the whole sentence, of a file of version 0.1 or of something that is no branch.
    """

    reason: Reason
    value: float = float("nan")
    point: str | None = None
    other: str | None = None
    kind: str | None = None
    text: str = ""

    @classmethod
    def of(cls, status: Status, value: float) -> Ending:
        """The ending by which the continuation loop stopped."""
        return cls(Reason[status.name], float(value))

    @classmethod
    def said(cls, text: str) -> Ending:
        """An ending of which only a sentence is known."""
        return cls(Reason.SAID, text=text)

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> Ending:
        """What `to_dict` made."""
        return cls(**{**content, "reason": Reason(content["reason"])})

    def to_dict(self) -> dict[str, Any]:
        """As JSON scalars."""
        return {**asdict(self), "reason": self.reason.value}

    def sentence(self, parameter: str, unit: float = 1.0) -> str:
        """The ending for people; ``unit`` is the size of the parameter, beside which rounding is zero."""
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
        said = Status[self.reason.name].sentence(parameter, self.value, unit)
        return f"{said}; {self.text}" if self.text else said


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
    values : ndarray, shape (n,)
        Parameter values.
    tangents : ndarray, shape (n, N + 1)
        Unit tangents (in the metric of the continuation), all pointing forward along the stored order.
    multipliers : ndarray of complex, shape (n, m)
        Of the full period (eigenvalues for flows).
    margin : ndarray, shape (n,)
        Smallest margin, +inf for a problem without margins.
    stable : ndarray of bool, shape (n,), or None
        A special point counts as stable when one of its neighbours is. None: stability is not computed, as for a problem
        with ``spectrum="none"``.
    real : bool
        False: beyond a border, no machine follows it.
    endings : (Ending, Ending)
        Why the branch ends, at its first and at its last point; as sentences in ``ended``.
    closed : bool
        The last point is the first one again (modulo the shift by a period).
    seed : str or None
        Label of the special point from which the branch was reached.
    marks : tuple of (int, str)
        Index and label of each special point on the branch, in order.
    description : dict
        What ``problem.describe()`` said.
    parameter : str
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
    endings: tuple[Ending, Ending] = (Ending.said(""), Ending.said(""))
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
        """The points as a data frame; see :func:`contvines.export.frames.branch_frame`."""
        from ..export.frames import branch_frame

        return branch_frame(self)

    def to_xarray(self):
        """The branch as a data set; see :func:`contvines.export.frames.branch_dataset`."""
        from ..export.frames import branch_dataset

        return branch_dataset(self)

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest parameter value."""
        return float(np.min(self.values)), float(np.max(self.values))

    @property
    def ended(self) -> tuple[str, str]:
        """Why the branch ends, at its first and at its last point, in words."""
        unit = float(np.abs(self.values).max(initial=0.0))
        first, last = (ending.sentence(self.parameter, unit) for ending in self.endings)
        return first, last

    def pieces(self) -> list[tuple[int, int, bool | None]]:
        """Runs of equal stability: (first, last, stable) with inclusive indices, neighbours sharing a point.

        One run, ``stable`` None, where stability is not computed.
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
        """Parameter intervals of the pieces that are known to be stable, in increasing order; on a closed branch none is cut where it begins."""
        pieces = self.pieces()
        parts = [self.values[first : last + 1] for first, last, stable in pieces if stable]
        if self.closed and len(pieces) > 1 and pieces[0][2] and pieces[-1][2]:
            parts[0] = np.concatenate([parts.pop(), parts[0]])
        return sorted((float(part.min()), float(part.max())) for part in parts)

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Names that `measure` knows beside the parameter's own; without a problem ``norm``, and of flows what needs no right-hand side."""
        bare = self._bare
        names = ("norm",) if bare is None else bare.names
        names = names if self.problem is None else self.problem.measure_names
        return tuple(str(name) for name in names if name != self.parameter)

    def measure(self, name: str) -> np.ndarray:
        """A measure along the branch, shape (n,); names: `measure_names`, and the parameter's own name.

        Raises
        ------
        KeyError
            If the problem has no such measure.
        """
        # pictures and surveys ask for the same one again and again
        known = vars(self).setdefault("_measured", {})
        points, values, found = known.get(name, (None, None, None))
        if points is not self.points or values is not self.values:
            found = self.measure_of(name, self.points, self.values)
            known[name] = self.points, self.values, found
        return np.array(found)

    def measure_of(self, name: str, u: np.ndarray, p: np.ndarray) -> np.ndarray:
        """A measure of other solutions of this branch's problem: `u` of shape (m, N), `p` and the result of shape (m,)."""
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
        """Name of the measure that pictures show if none is named; empty where the problem is not known."""
        if self.problem is not None:
            return self.problem.default_measure
        return "" if self._bare is None else f"max {self._bare.states[0]}"

    @property
    def _bare(self) -> MeasuresWithoutRates | None:
        """What is measured of a flow that was loaded without its problem."""
        if self.problem is not None or "flow" not in self.description:
            return None
        from ..flows.measures import measures_without_rates  # which diagrams of machines do without

        return measures_without_rates(self.description, self.points.shape[1])

    @property
    def attached(self) -> Problem:
        """The problem.

        Raises
        ------
        ValueError
            If there is none, as after loading.
        """
        if self.problem is None:
            raise ValueError(without_problem(self.label, self.description))
        return self.problem

    def orbit(self, i: int) -> Any:
        """The solution at point i as the object that the problem hands to users; at a border with the multipliers' limits."""
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
        bits : int, optional
            Not used: stretches are proved with a fixed precision.
        special : dict, optional
            The graph's special points by label: stretches then go up to the points themselves.

        Raises
        ------
        ValueError
            If the problem has no proofs.
        """
        if not isinstance(self.problem, Provable):
            raise ValueError(
                f"{self.label}: its problem offers no proofs of branches; machines of orbits with flights in closed form do"
            )
        known = {i: special[label] for i, label in self.marks if special and label in special}
        return self.problem.prove_branch(self.points, self.values, [i for i, _ in self.marks], within, known)

    def to_dict(self) -> dict[str, Any]:
        """The entry of this branch in the JSON of a graph."""
        about = self.description
        return {
            "label": self.label,
            "word": about.get("word"),
            "periods": about.get("periods"),
            "impacts": about.get("impacts"),
            "symmetric": about.get("symmetric"),
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
    if name == "norm":
        return np.linalg.norm(u, axis=1)
    if name.startswith("u") and name[1:].isdigit() and int(name[1:]) < u.shape[1]:
        return u[:, int(name[1:])]
    raise KeyError(
        f"{label} was loaded without its problem; only norm and u0, u1 ... can be measured, not {name!r}"
    )
