"""SpecialPoint: a located bifurcation, border or end of a branch, with multipliers, errors and normal form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kinds import BORDERS, critical
from ..continuation.settings import hinted
from ..problems.abilities import Limited, Provable, Resolved
from ..problems.registry import without_problem
from ..shared.numbers import pairs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..bifurcation.kind import Kind
    from ..problems.protocol import Problem


class LazyNumber:
    """A field of a dataclass that is a number or None, and may be set to a function without arguments that computes it at first use.

    Normal-form coefficients and simulations of special points take a good part of the time of a diagram, and surveys of many
    diagrams need neither.
    """

    def __set_name__(self, owner: type, name: str) -> None:
        self.place = "_" + name

    def __get__(self, instance: object, owner: type | None = None) -> float | None:
        if instance is None:
            return None  # the default
        value: float | Callable[[], float | None] | None = vars(instance)[self.place]
        if callable(value):
            value = vars(instance)[self.place] = value()
        return value

    def __set__(self, instance: object, value: float | Callable[[], float | None] | None) -> None:
        vars(instance)[self.place] = value


TRANSCRITICAL = "transcritical"  #: remark at a branch point: the leaving branch has a nonzero slope, so it is neither super- nor subcritical


@hinted
@dataclass(eq=False, repr=False)
class SpecialPoint:
    """A special point of a branch.

    Attributes
    ----------
    label : str
        Label in the graph: LP1, SB1, PD1 ...
    kind : str
        Name of the kind; see :data:`contvines.KINDS`.
    branch : str
        Label of the branch on which it was located.
    value : float
        Parameter value.
    parameter : str
        Name of the parameter.
    u : ndarray, shape (N,)
        The solution, in the unknowns of the branch's problem.
    tangent : ndarray, shape (N + 1,)
        Unit tangent of the branch, in the order in which the branch is stored.
    multipliers : ndarray of complex
        Multipliers of the full period (eigenvalues for flows).
    margins : float
        Smallest margin; +inf for a problem without margins.
    bracket : (float, float)
        Parameter values between which the point was detected.
    residual : float
        Largest absolute residual at the point.
    location_error : float
        Estimated error of ``value``.
    real : bool
        True if no margin is negative. A border point itself is real, even if located from its virtual side.
    criticality : {"supercritical", "subcritical"} or None
    coefficient : float or None
        Normal-form coefficient (Kuznetsov, *Elements of Applied Bifurcation Theory*, sections 4.5, 5.4, 7.4); computed at first use.
    replay : float or None
        Deviation of an event-driven simulation from the solution; simulated at first use.
    multipliers_beyond : ndarray of complex or None
        At a border: multipliers of the solution on the other side.
    mirror : bool
        True if the branch that leaves here has a mirror image that is not traced.
    name : str
        Name of the user function, at its zeros.
    met_from : str or None
        Label of a branch of less symmetric solutions that ends here.
    remarks : tuple of str
        Further sentences for the user.
    margin_index : int or None
        Column of the margin that vanishes at a border.
    index : int
        Index of the point in the arrays of its branch.
    problem : Problem or None
        None after loading a graph whose problem came from a Python callable.
    own_kind : Kind or None
        The kind, if it is user-defined; None after loading.
    """

    label: str
    kind: str
    branch: str
    value: float
    parameter: str
    u: np.ndarray = field(repr=False)
    tangent: np.ndarray = field(repr=False)
    multipliers: np.ndarray = field(repr=False)
    margins: float = float("inf")
    bracket: tuple[float, float] = (float("nan"), float("nan"))
    residual: float = 0.0
    location_error: float = 0.0
    real: bool = True
    criticality: str | None = None
    coefficient: LazyNumber = LazyNumber()
    replay: LazyNumber = LazyNumber()
    multipliers_beyond: np.ndarray | None = field(default=None, repr=False)
    mirror: bool = False
    name: str = ""
    met_from: str | None = None
    remarks: tuple[str, ...] = ()
    margin_index: int | None = None
    index: int = -1
    problem: Problem | None = field(default=None, repr=False)
    own_kind: Kind | None = field(default=None, repr=False)

    @property
    def note(self) -> str:
        """Name of the user function, label of the branch that ends here, and remarks, in one text."""
        origin = f"met from {self.met_from}" if self.met_from else ""
        return "; ".join(filter(None, (self.name, origin, *self.remarks)))

    @property
    def attached(self) -> Problem:
        """The problem of the point.

        Raises
        ------
        ValueError
            If there is none, as after loading a graph of Python callables.
        """
        if self.problem is None:
            raise ValueError(without_problem(self.label))
        return self.problem

    @property
    def frequency(self) -> float | None:
        """Angular frequency of the critical pair: omega at a Hopf point, the angle per period at a Neimark-Sacker point; None at other points."""
        upper = self.multipliers[np.imag(self.multipliers) > 0.0]
        if self.kind not in ("hopf", "neimark-sacker") or not len(upper):
            return None
        if self.kind == "hopf":
            return float(np.imag(upper[np.argmin(np.abs(np.real(upper)))]))
        return float(np.angle(upper[np.argmin(np.abs(np.abs(upper) - 1.0))]))

    @property
    def eigenvectors(self) -> np.ndarray:
        """Eigenvectors as columns, shape (N, m), of unit length; column j belongs to ``multipliers[j]``.

        They belong to dF/du; for a cycle of a map to the product of its Jacobians, from its first point.

        Raises
        ------
        ValueError
            If the problem is not attached or does not provide eigenvectors.
        """
        problem = self.attached
        if not isinstance(problem, Resolved):
            raise ValueError(
                f"{self.label}: its problem provides no eigenvectors; problems made of your own equations do"
            )
        return problem.eigenvectors(self.u, self.value, self.multipliers)

    @property
    def orbit(self) -> Any:
        """The solution as the problem's object for users, for example an orbit.

        At a border it has the one-sided limits of the multipliers. At a bifurcation its stability is undecided, unless other multipliers are
        outside the circle.
        """
        found = self.attached.orbit(self.u, self.value)
        if self.kind in BORDERS and isinstance(found, Limited):
            return found.with_multipliers(self.multipliers)
        return critical(found, self.kind)

    def plot(self, **options: Any) -> Figure:
        """Draw the solution as a matplotlib figure; see :func:`contvines.plots.portrait.plot_portrait`."""
        from ..plots.portrait import plot_portrait

        return plot_portrait(self.orbit, **options)

    def circles(self, to: float | None = None, **options: int):
        """Compute the invariant circles that are born at a Neimark-Sacker point, up to the parameter value `to`.

        Arguments, result and errors are those of :func:`contvines.circles.follow.circles`.
        """
        from ..circles.follow import circles

        return circles(self, to, **options)

    def cycles(self) -> object:
        """Return one of the small cycles that are born at a Hopf point: a seed for ``contvines.diagram``.

        Raises
        ------
        ValueError
            If it is no Hopf point of a flow, or no cycle is found.
        """
        if self.kind != "hopf":
            raise ValueError(f"{self.label} is a point of kind {self.kind}; cycles are born at Hopf points")
        from ..graph.schedule_branches import cycle_at

        return cycle_at(self)

    def __repr__(self) -> str:
        virtual = "" if self.real else "virtual "
        side = f", {self.criticality}" if self.criticality else ""
        position = f"{self.parameter} = {self.value:.12g}"
        return f"SpecialPoint({self.label}: {virtual}{self.kind} on {self.branch} at {position}{side})"

    def _repr_html_(self) -> str:
        from ..graph.table import point_page

        return point_page(self)

    def prove(self, bits: int | None = None) -> object:
        """Prove the point as a regular zero of its defining system, for problems with proofs: `orbits` with closed-form flights.

        Raises
        ------
        ValueError
            If the problem has no proofs.
        """
        if not isinstance(self.problem, Provable):
            raise ValueError(
                f"{self.label}: its problem offers no proofs; machines of orbits with flights in closed form do"
            )
        return self.problem.prove(self.kind, self.u, self.value, margin=self.margin_index, bits=bits)

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of this point in the JSON of a graph."""
        return {
            "label": self.label,
            "kind": self.kind,
            "branch": self.branch,
            "value": {self.parameter: float(self.value)},
            "multipliers": pairs(self.multipliers),
            "real": bool(self.real),
            "criticality": self.criticality,
            "residual": float(self.residual),
            "replay": None if self.replay is None else float(self.replay),
            "coefficient": None if self.coefficient is None else float(self.coefficient),
            "location_error": float(self.location_error),
            "bracket": [float(self.bracket[0]), float(self.bracket[1])],
            "multipliers_beyond": None if self.multipliers_beyond is None else pairs(self.multipliers_beyond),
            "mirror": bool(self.mirror),
            "note": self.note,
        }
