"""What some problems can beside the protocol, each a small protocol of its own; ``isinstance`` tells whether a problem can."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.figure import Figure
    from scipy.sparse import csc_array

    from .functions import Operator
    from .populations import Population
    from .protocol import BorderPoint, Problem, Seed


@runtime_checkable
class Started(Protocol):
    """Has a start of its own: unknowns and the value of the parameter."""

    @property
    def u0(self) -> np.ndarray: ...
    @property
    def p0(self) -> float: ...


@runtime_checkable
class Evaluable(Protocol):
    """Its equations can be evaluated without their derivatives."""

    def residuals(self, u: np.ndarray, p: float) -> np.ndarray: ...


@runtime_checkable
class Named(Protocol):
    """Its unknowns have names of their own."""

    def unknown_name(self, i: int) -> str: ...


@runtime_checkable
class Rough(Protocol):
    """May be given a rough start: its equations can be evaluated without their derivatives, and the lengths over which they bend are known."""

    @property
    def lengths(self) -> np.ndarray: ...
    def residuals(self, u: np.ndarray, p: float) -> np.ndarray: ...


class Section(Protocol):
    """Motions seen once per period; see the contract of :mod:`contvines.circles.section`."""

    @property
    def names(self) -> tuple[str, ...]: ...
    def through(self, u: np.ndarray) -> np.ndarray: ...
    def rounds(self, u: np.ndarray) -> np.ndarray: ...
    def step(self, x: np.ndarray) -> np.ndarray: ...


@runtime_checkable
class Sectioned(Protocol):
    """Its motions can be simulated period by period; see :mod:`contvines.circles.section`."""

    def section(self, p: float) -> Section: ...


@runtime_checkable
class Gauged(Protocol):
    """Its states may have units: what one of a coordinate of its section is in the unit in which it is shown, and that unit; none for plain numbers."""

    def gauges(self, names: Sequence[str], p: float) -> dict[str, tuple[float, str]]: ...


@runtime_checkable
class Notated(Protocol):
    """Labels of axes for its parameters and measures, by name, in the field's notation."""

    @property
    def notation(self) -> Mapping[str, str]: ...


def notation_of(*things: object) -> dict[str, str]:
    """The labels of the first of these (problems, populations, families) that has any; names without one are shown as they are."""
    return next((dict(thing.notation) for thing in things if isinstance(thing, Notated)), {})


@runtime_checkable
class Populated(Protocol):
    """Many starts can be simulated; see :mod:`contvines.problems.populations`."""

    def population(self, over: str | None = None, **parameters: float) -> Population: ...


@runtime_checkable
class Attracting(Protocol):
    """Tells of a solution that is known to be stable what ``simulated_attractors`` would tell of it."""

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]: ...


@runtime_checkable
class Onward(Protocol):
    """Tells of ``beyond`` what needs no switch alone; what leaves with another period or symmetry only where nothing else is found."""

    def onward(self, point: BorderPoint) -> Sequence[Seed]: ...


@runtime_checkable
class Resolved(Protocol):
    """Tells the eigenvectors that belong to multipliers, as columns."""

    def eigenvectors(self, u: np.ndarray, p: float, values: np.ndarray) -> np.ndarray: ...


@runtime_checkable
class Limited(Protocol):
    """Of what ``orbit`` returned: takes the multipliers that a branch has in the limit, where its own equations are singular."""

    def with_multipliers(self, multipliers: np.ndarray) -> object: ...


@runtime_checkable
class Critical(Protocol):
    """Of what ``orbit`` returned: at a special point its nearest multipliers are on the unit circle (eigenvalues on the axis) by definition."""

    def critical(self, near: float) -> object:
        """The same solution with the multipliers there that are so near to the circle; of an equilibrium one always is."""
        ...


@runtime_checkable
class Drawable(Protocol):
    """Of what ``orbit`` returned: draws itself."""

    def plot(self, **options: object) -> Figure: ...


@runtime_checkable
class Animated(Protocol):
    """Of what ``orbit`` returned: has a motion, for the page of a report."""

    def scene(self, samples: int) -> dict[str, Any]: ...


@runtime_checkable
class Provable(Protocol):
    """Special points and branches can be proved."""

    def prove(
        self, kind: str, u: np.ndarray, p: float, margin: int | None = None, bits: int | None = None
    ) -> object: ...

    def prove_branch(
        self,
        points: np.ndarray,
        values: np.ndarray,
        marks: Sequence[int] = (),
        within: tuple[float, float] | None = None,
        special: Mapping[int, BorderPoint] | None = None,
    ) -> object: ...


@runtime_checkable
class Linearised(Protocol):
    """Of the workspace of problems made of Python callables: F, F_u and F_p."""

    @property
    def residual(self) -> np.ndarray: ...
    @property
    def jacobian(self) -> np.ndarray | csc_array | Operator: ...
    @property
    def derivative(self) -> np.ndarray: ...


@runtime_checkable
class Blurred(Protocol):
    """Tells by how much rounding of its linearisation moves a raw eigenvalue."""

    def blur(self, work: object) -> float: ...


@runtime_checkable
class Doubtful(Protocol):
    """Tells by how much the entries of (F_u, F_p) of its last linearisation may be wrong, shape (N, N + 1), an array or a sparse matrix.

    `rounding`: of an entry relative to it. None where nobody knows.
    """

    def doubts(self, work: object, rounding: float) -> np.ndarray | csc_array | None: ...


@runtime_checkable
class Nearing(Protocol):
    """May have many unknowns: how near it is to a branch point is then told cheaply, by eigenvalues only where it is looked at closely; see :mod:`.spectra`.

    `signed`: whether the sign of the determinant is known. `closer` hands out the same problem with eigenvalues.
    """

    many: bool
    signed: bool

    def closer(self) -> Problem: ...


class Returns(Protocol):
    """A return map near a cycle, in coordinates of the section: states = ``basis`` x."""

    basis: np.ndarray
    inverse: np.ndarray
    node: int

    def __call__(self, points: np.ndarray, /) -> np.ndarray: ...
    def varied(self, points: np.ndarray, /) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...


@runtime_checkable
class Returning(Protocol):
    """Its solutions are fixed points of return maps, ``return_map(u, p)``; see :mod:`contvines.flows.returns`."""

    def return_map(self, u: np.ndarray, p: float) -> Returns: ...


@runtime_checkable
class EndsOnMesh(Protocol):
    """Branches on a mesh of which it is known by how much the parameter at their ends may be off: ``remaining(u, tangent)`` where the period grows
    without bound, ``touch_error(point)`` at a border that is met between the mesh points.
    """

    def remaining(self, u: np.ndarray, tangent: np.ndarray) -> float: ...
    def touch_error(self, point: BorderPoint) -> float: ...


@runtime_checkable
class Moving(Protocol):
    """Its unknowns belong to a mesh that moves along while a branch is followed.

    ``held`` are those unknowns that no equation determines: corrections leave them as they are. ``steer(u, tangent)`` chooses, in place, of all directions
    that change the solution alike the one that changes the other unknowns least, ``stand(u, tangent)`` the one of a mesh that stands where it is.
    ``carried(u, other)`` reads unknowns on the mesh of others.
    """

    held: slice

    def steer(self, u: np.ndarray, tangent: np.ndarray) -> None: ...
    def stand(self, u: np.ndarray, tangent: np.ndarray) -> None: ...
    def carried(self, u: np.ndarray, other: np.ndarray) -> np.ndarray: ...


@runtime_checkable
class Several(Protocol):
    """Has a problem for each branch: ``problem_of(description)`` is the one that described itself so."""

    def problem_of(self, description: Mapping[str, Any]) -> Problem: ...


@runtime_checkable
class Adaptive(Protocol):
    """Its unknowns belong to a mesh, which is adapted while a branch is followed, after every ``chunk`` points.

    ``adapted(u)`` returns how unknowns, and directions of unknowns (``image(v, direction=True)``), read on a better mesh, or None;
    ``accuracy(u, p)`` is the relative accuracy of values on the mesh; ``normal_form`` is the coefficient at a fold (of the sign ``along`` a direction), a period doubling, a pitchfork or a Neimark-Sacker point, with the sum of the magnitudes of its terms;
    ``anchor(u, p)`` keeps the phase of a solution for those that follow, until ``anchor(None)``, and ``in_phase(u)`` tells whether it suits another one;
    ``terms(u)`` has the sizes of the terms of each equation, which may cancel and round as numbers of that size do;
    ``lags(u)`` tells whether a solution asks for another mesh, ``too_coarse(u, p)`` whether more unknowns are needed, and ``refined()`` and ``halved(u, direction)`` have these: on the same intervals,
    each halved, where ``parts_of_refined`` is 1; rows of an array may be unknowns then.
    """

    chunk: int

    @property
    def parts_of_refined(self) -> int: ...

    def accuracy(self, u: np.ndarray, p: float) -> float: ...
    def normal_form(
        self,
        kind: str,
        u: np.ndarray,
        p: float,
        multiplier: complex = -1.0,
        along: np.ndarray | None = None,
    ) -> tuple[float, float] | None: ...
    def anchor(self, u: np.ndarray | None, p: float = 0.0) -> None: ...
    def in_phase(self, u: np.ndarray) -> bool: ...
    def terms(self, u: np.ndarray) -> np.ndarray: ...
    def adapted(self, u: np.ndarray) -> Callable[..., np.ndarray] | None: ...
    def lags(self, u: np.ndarray) -> bool: ...
    def too_coarse(self, u: np.ndarray, p: float, stuck: bool = False) -> bool: ...
    def refined(self) -> Problem: ...
    def halved(self, u: np.ndarray, direction: bool = False) -> np.ndarray: ...
