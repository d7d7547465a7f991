"""Optional abilities of problems, each a small protocol; ``isinstance(problem, Ability)`` tests whether a problem has one.

A few are abilities of other objects (orbits, workspaces, populations); their docstrings name the object.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.figure import Figure
    from scipy.sparse import csc_array

    from ..shared.motions import Motion
    from .functions import Operator
    from .protocol import BorderPoint, Problem, Seed


@runtime_checkable
class Started(Protocol):
    """A problem with a start: unknowns ``u0`` and parameter value ``p0``."""

    @property
    def u0(self) -> np.ndarray: ...
    @property
    def p0(self) -> float: ...


@runtime_checkable
class Evaluable(Protocol):
    """A problem whose residual can be evaluated without derivatives."""

    def residuals(self, u: np.ndarray, p: float) -> np.ndarray: ...


@runtime_checkable
class Named(Protocol):
    """A problem that names its unknowns."""

    def unknown_name(self, i: int) -> str: ...


@runtime_checkable
class Rough(Protocol):
    """A problem that may begin at a rough guess: its residual can be evaluated without derivatives, and ``lengths`` are the changes of each unknown over which F is nonlinear."""

    @property
    def lengths(self) -> np.ndarray: ...
    def residuals(self, u: np.ndarray, p: float) -> np.ndarray: ...


class Section(Protocol):
    """A stroboscopic or Poincaré section, computed by simulation; the contract is in :mod:`contvines.circles.section`."""

    @property
    def names(self) -> tuple[str, ...]: ...
    def through(self, u: np.ndarray) -> np.ndarray: ...
    def rounds(self, u: np.ndarray) -> np.ndarray: ...
    def step(self, x: np.ndarray) -> np.ndarray: ...


@runtime_checkable
class Sectioned(Protocol):
    """A problem whose motions can be simulated period by period; see :mod:`contvines.circles.section`."""

    def section(self, p: float) -> Section: ...


@runtime_checkable
class Gauged(Protocol):
    """A problem or population whose section coordinates may have units.

    ``gauges(names, p)`` returns, for each coordinate with a unit, the factor from computed to displayed numbers, and the unit's name.
    """

    def gauges(self, names: Sequence[str], p: float) -> dict[str, tuple[float, str]]: ...


@runtime_checkable
class Notated(Protocol):
    """A problem, population or family with axis labels for its parameters and measures, by name."""

    @property
    def notation(self) -> Mapping[str, str]: ...


def notation_of(*things: object) -> dict[str, str]:
    """Return the axis labels of the first of these (problems, populations, families) that is `Notated`; empty if none is."""
    return next((dict(thing.notation) for thing in things if isinstance(thing, Notated)), {})


@runtime_checkable
class Population(Protocol):
    """Starts of a problem, and the motions that they settle on.

    The contract:

    1. ``population.starts(count, seed, p)`` draws starts, shape (count, n), in the machine's box; equal seeds give equal starts.
    2. ``population.settle(starts, p)`` returns ``(motions, index, mirrored)``: the motions reached, each once; for each start the index of its
       motion; and for each start whether it reaches the mirror image of that motion. The result depends on the starts alone.
    3. A motion has ``kind``, ``word``, ``periods``; ``exponent`` and ``error`` (largest Lyapunov exponent per period and its standard error;
       nan for periodic motions); ``problem`` and ``u`` if it is a solution that can be continued, else None; and ``state``, a state on the
       motion, if there is one.
    4. ``population.about`` describes the machine for the graph (JSON-able); ``population.names`` are the coordinates of a start, ``population.box(p)`` their ranges, shape (n, 2).
       Optional: ``population.notation``, axis labels by coordinate; ``population.leftward``, the coordinate whose axis is drawn from right to left.
    5. ``population.brief`` is the number of parameter values, and of starts at each, of the brief search after a diagram; it should cost a
       fraction of the diagram. ``population.price`` is the cost of a solution relative to one of a closed-form machine; ``population.across`` the
       default number of starts along each side of a picture of basins.
    6. ``population.embedded(motion.state, p)`` returns ``(problem, u)`` of unstable cycles that a chaotic motion passes near, each once.
       Periodic windows are born as pairs of cycles, and the unstable cycle of a pair persists in the chaos next to the window: continuing
       it back leads to windows that are too narrow to be hit by starts.
    7. ``population.returning(starts, p)`` returns ``(problem, u)`` of cycles, stable or unstable, that Newton's method on the return map finds
       from starts, each once; many more starts converge to a cycle than settle on it. Motions known in closed form are included.
    8. ``population.closed(p)`` returns ``(problem, u)`` of the motions known in closed form, stable or unstable, each once.
    9. ``population.restored(problem.describe(), u, p)`` rebuilds the problem of a motion that `settle`, `embedded` or `returning` found at p, with the same
       scales; None if it cannot be rebuilt.
    10. ``population.observed(motion.state, p, periods)`` simulates the motion through a state and returns its measures by name; a motion that is not
        periodic is simulated for at least `periods` periods. Empty without a state.
    11. ``population.work`` counts the forcing periods (steps of a map) simulated so far, for the budget of an atlas.
    """

    work: float

    @property
    def parameter(self) -> str: ...
    @property
    def about(self) -> dict[str, Any]: ...
    @property
    def names(self) -> tuple[str, ...]: ...

    @property
    def brief(self) -> tuple[int, int]: ...

    @property
    def across(self) -> int: ...

    @property
    def price(self) -> float: ...

    def box(self, p: float) -> np.ndarray: ...

    def starts(self, count: int, seed: int, p: float) -> np.ndarray: ...

    def settle(
        self, starts: np.ndarray, p: float
    ) -> tuple[Sequence[Motion[Problem]], np.ndarray, np.ndarray]: ...

    def embedded(self, state: np.ndarray, p: float) -> Sequence[tuple[Problem, np.ndarray]]: ...

    def returning(self, starts: np.ndarray, p: float) -> Sequence[tuple[Problem, np.ndarray]]: ...

    def closed(self, p: float) -> Sequence[tuple[Problem, np.ndarray]]: ...

    def restored(self, description: Mapping[str, Any], u: np.ndarray, p: float) -> Problem | None: ...

    def observed(self, state: np.ndarray | None, p: float, periods: float = 0.0) -> dict[str, float]: ...


@runtime_checkable
class Populated(Protocol):
    """A problem that can simulate many starts; see :class:`Population`."""

    def population(self, over: str | None = None, **parameters: float) -> Population: ...


@runtime_checkable
class Attracting(Protocol):
    """A problem that describes a stable solution as an entry of ``simulated_attractors``, without a simulation."""

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]: ...


@runtime_checkable
class Onward(Protocol):
    """A problem with a shorter list than ``beyond`` at a border.

    ``onward`` returns only the branches that continue without a switch (``persistence``); branches with another period or symmetry are
    included only if there are no others.
    """

    def onward(self, point: BorderPoint) -> Sequence[Seed]: ...


@runtime_checkable
class Resolved(Protocol):
    """A problem that computes eigenvectors of given multipliers, as columns."""

    def eigenvectors(self, u: np.ndarray, p: float, values: np.ndarray) -> np.ndarray: ...


@runtime_checkable
class Limited(Protocol):
    """An orbit (result of ``orbit``) at the end of a branch, where its own equations are singular: ``with_multipliers`` sets the branch's multipliers in the limit."""

    def with_multipliers(self, multipliers: np.ndarray) -> object: ...


@runtime_checkable
class Critical(Protocol):
    """An orbit (result of ``orbit``) at a special point, where multipliers lie on the unit circle (eigenvalues on the imaginary axis) by definition."""

    def critical(self, near: float) -> object:
        """Return the same solution with the multipliers nearer than `near` to the unit circle moved onto it; of an equilibrium at least the nearest eigenvalue."""
        ...


@runtime_checkable
class Drawable(Protocol):
    """An orbit (result of ``orbit``) that draws itself."""

    def plot(self, **options: object) -> Figure: ...


@runtime_checkable
class Animated(Protocol):
    """An orbit (result of ``orbit``) with an animation for the report's HTML page."""

    def scene(self, samples: int) -> dict[str, Any]: ...


@runtime_checkable
class Provable(Protocol):
    """A problem whose special points and branches can be proved in ball arithmetic."""

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
        bits: int | None = None,
    ) -> object: ...


@runtime_checkable
class Linearised(Protocol):
    """A workspace of problems made of Python callables: F, F_u and F_p."""

    @property
    def residual(self) -> np.ndarray: ...
    @property
    def jacobian(self) -> np.ndarray | csc_array | Operator: ...
    @property
    def derivative(self) -> np.ndarray: ...


@runtime_checkable
class Blurred(Protocol):
    """A problem that estimates how much rounding of F_u moves a raw eigenvalue (``blur``)."""

    def blur(self, work: object) -> float: ...


@runtime_checkable
class Doubtful(Protocol):
    """A problem that bounds the errors of its derivatives.

    ``doubts(work, rounding)`` returns the largest errors of the entries of (F_u, F_p) in the last linearisation, shape (N, N + 1), dense
    or sparse; None if unknown. `rounding` is the relative rounding error of an entry.
    """

    def doubts(self, work: object, rounding: float) -> np.ndarray | csc_array | None: ...


@runtime_checkable
class Nearing(Protocol):
    """A problem that may have too many unknowns for eigenvalues at every point.

    If ``many``, its spectrum is a cheap distance from a singular F_u (see :mod:`.spectra`), and ``closer`` returns the same problem with
    eigenvalues, for segments near branch points. ``signed``: whether the sign of det F_u is known.
    """

    many: bool
    signed: bool

    def closer(self) -> Problem: ...


class Returns(Protocol):
    """A return map near a cycle, in coordinates x of the section: state = ``basis`` x."""

    basis: np.ndarray
    inverse: np.ndarray
    node: int

    def __call__(self, points: np.ndarray, /) -> np.ndarray: ...
    def varied(self, points: np.ndarray, /) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...


@runtime_checkable
class Returning(Protocol):
    """A problem whose solutions are fixed points of return maps; see :mod:`contvines.flows.returns`."""

    def return_map(self, u: np.ndarray, p: float) -> Returns: ...


@runtime_checkable
class EndsOnMesh(Protocol):
    """A problem on a mesh that estimates the error of the parameter where its branches end.

    ``remaining(u, tangent)``: distance of the parameter from its limit where the period grows without bound;
    ``touch_error(point)``: error at a border that is met between mesh points.
    """

    def remaining(self, u: np.ndarray, tangent: np.ndarray) -> float: ...
    def touch_error(self, point: BorderPoint) -> float: ...


@runtime_checkable
class Moving(Protocol):
    """A problem whose unknowns include a mesh that moves while a branch is followed.

    ``held`` is the slice of unknowns that no equation determines (widths of the mesh intervals); corrections do not change them.
    Many tangents describe the same change of the solution and differ only in the motion of the mesh: ``steer(u, tangent)`` changes the tangent,
    in place, to the one with the smallest change of the other unknowns, ``stand(u, tangent)`` to the one with a fixed mesh.
    ``carried(u, other)`` returns the unknowns u interpolated to the mesh of `other`.
    """

    held: slice

    def steer(self, u: np.ndarray, tangent: np.ndarray) -> None: ...
    def stand(self, u: np.ndarray, tangent: np.ndarray) -> None: ...
    def carried(self, u: np.ndarray, other: np.ndarray) -> np.ndarray: ...


@runtime_checkable
class Several(Protocol):
    """A family of problems, such as a flow with its equilibria and cycles: ``problem_of(description)`` rebuilds the one whose ``describe`` returned the description."""

    def problem_of(self, description: Mapping[str, Any]) -> Problem: ...


@runtime_checkable
class Adaptive(Protocol):
    """A problem on a mesh that is adapted after every ``chunk`` points of a branch.

    | member | meaning |
    |---|---|
    | ``adapted(u)`` | interpolation ``image(v, direction=False)`` of unknowns, or of directions, to a better mesh; None if the mesh is good |
    | ``accuracy(u, p)`` | relative accuracy of values on the mesh |
    | ``normal_form`` | coefficient at a fold (with its sign `along` a direction), period doubling, pitchfork or Neimark-Sacker point, and the sum of the magnitudes of its terms |
    | ``anchor(u, p)`` | use the phase of u in the phase condition, until ``anchor(None)`` |
    | ``in_phase(u)`` | whether u is similar enough to the solution whose phase is used |
    | ``terms(u)`` | sizes of the terms of each equation; they may cancel, and their rounding errors have this scale |
    | ``lags(u)`` | whether the error of u on its own mesh is too large |
    | ``too_coarse(u, p)`` | whether more unknowns are needed; `stuck`: Newton's method has failed next to u |
    | ``refined()`` | the problem with more unknowns |
    | ``halved(u, direction)`` | unknowns, or a direction, in the refined problem |
    | ``parts_of_refined`` | 1: every interval is halved, and ``halved`` accepts arrays whose rows are unknowns; 2: the refined mesh has two equal halves |
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
