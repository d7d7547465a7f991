"""Kernels of cycles: collocation equations with phase and mesh, linearised and solved by orthogonal elimination."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ..core.library import native
from ..problems.dense import assign
from ..problems.functions import NotEvaluable
from ..problems.protocol import Kernels
from .core import CoreCycle, CoreRates
from .elimination import condense, multipliers_of, solve_collocation
from .sparse import SparseEquations, leading_multipliers, solve_bordered

if TYPE_CHECKING:
    from scipy.sparse import csc_array

    from ..problems.functions import ParameterSet
    from .collocation import Rule
    from .field import Field

NOTHING = (np.zeros(0), np.zeros(0))
NOWHERE = (np.zeros(0), math.nan, np.zeros(0), np.zeros(0))  # before the first linearisation
LARGEST = 707.0  # logarithms of multipliers are clamped here, where floats end


class Collocated(Protocol):
    """What the kernels read of a problem, their `data` (`contvines.flows.cycles.CycleProblem`)."""

    column_scale: np.ndarray
    dimension: int
    field: Field
    clock: float
    free_period: int
    intervals: int
    missed: float
    n_margins: int
    n_multipliers: int
    node: int
    node_scale: np.ndarray
    parameter_scale: float
    row_scale: np.ndarray
    rule: Rule
    sparse: SparseEquations | None
    states: int
    trouble: str
    values: ParameterSet

    @property
    def parameter(self) -> str: ...

    def evaluate(self, u: np.ndarray, p: float, work: CycleWork) -> None: ...
    def margins(self, u: np.ndarray, work: CycleWork) -> np.ndarray: ...


class CycleWork:
    """What a linearisation leaves behind, in units of the scales.

    ``self[0]`` is F, ``self[1]`` is F_p. Equations and unknowns are those of :class:`contvines.flows.cycles.CycleProblem`.
    ``blocks`` (N, m d, (m + 1) d) are the derivatives of the collocation equations by the values at the nodes, ``by_period`` (N, m d) those
    by the period, ``phase`` (N, m d) the row of the phase condition.
    """

    def __init__(self, data: Collocated) -> None:
        count, inner, d, free = data.intervals, data.rule.degree * data.node, data.node, data.free_period
        self.residual, self.derivative = np.zeros(data.dimension), np.zeros(data.dimension)
        self.sparse: SparseEquations | None = data.sparse
        self.entries: np.ndarray = np.zeros(0)  # of the derivatives, where they are sparse
        self.blocks = np.zeros((count, inner, inner + d)) if self.sparse is None else np.zeros(0)
        self.by_period, self.phase = np.zeros((2, count, inner)) if free else np.zeros((2, 0))
        self.core = CoreCycle(data, self) if native() and self.sparse is None else None
        compiled = data.field.compiled
        self.rates: CoreRates | None = None  # of a right-hand side that the core calls by itself
        if self.core is not None and compiled is not None and compiled.complete and free:
            self.rates = CoreRates(compiled, len(data.field.values.values), count * data.rule.degree, d)
        self.steps: np.ndarray = np.zeros(0)  # lengths of the intervals in time
        self.along: tuple[np.ndarray, float, np.ndarray, np.ndarray] = (
            NOWHERE  # mesh points, parameter, Jacobians and rates at the Gauss points
        )
        self.mesh: tuple[np.ndarray, np.ndarray] | None = (
            None  # what is left of the equations between neighbouring mesh points
        )
        self.kept: tuple[np.ndarray, np.ndarray] = (
            NOTHING  # by_period and phase, while the closure is turned round
        )
        # F_u as a sparse matrix in the place of its blocks, where it has been transposed (loci)
        self.full: csc_array | None = None
        self.closure, self.corner = 1.0, 0.0

    def __getitem__(self, i: int) -> np.ndarray:
        return (self.residual, self.derivative)[i]


def linearise(data: Collocated, u: np.ndarray, p: float, work: CycleWork) -> float:
    """Residual and derivatives of the collocation equations; the largest residual in units of the rows."""
    work.mesh, work.full, work.closure, work.corner = None, None, 1.0, 0.0
    with np.errstate(all="ignore"):
        try:
            data.evaluate(u, p, work)
        except NotEvaluable as error:
            data.trouble = str(error)
            return math.inf
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            return math.inf
    size = float(np.abs(work.residual / data.row_scale).max())
    return size if size < math.inf else math.inf


def bordered(
    data: Collocated, work: CycleWork, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); returns the sign of the determinant."""
    core = work.core
    if core is not None and work.full is None:
        work.mesh = core.left, core.right
        return core.bordered(work.closure, work.corner, border, n, step, tangent)
    columns = np.concatenate([data.column_scale, [data.parameter_scale]])
    sides = np.zeros((len(border), 2))
    sides[:-1, 0], sides[-1] = -work.residual / data.row_scale, (n, 1.0)
    column = work.derivative / data.row_scale * data.parameter_scale
    with np.errstate(all="ignore"):
        try:
            if work.full is not None:
                found, sign = _solve_full(work, border * columns, column, sides)
            else:
                found, sign = _solve(data, work, border * columns, column, sides)
        except np.linalg.LinAlgError:
            step[:], tangent[:] = np.nan, np.nan
            return 0.0
    step[:], tangent[:] = found[:, 0] * columns, found[:, 1] * columns
    return sign


def _solve(
    data: Collocated, work: CycleWork, border: np.ndarray, column: np.ndarray, sides: np.ndarray
) -> tuple[np.ndarray, float]:
    """In units of the scales, by elimination interval by interval."""
    count, m, d, free = data.intervals, data.rule.degree, data.node, data.free_period
    states = count * m * d
    tail = slice(states + free, states + free + count)
    # the mesh keeps its widths: those rows are the identity
    widths = np.concatenate([-column[tail, None], sides[tail]], axis=1)  # by the parameter, then of each side
    shared = [work.by_period[:, :, None]] if free else []
    shared += [column[:states].reshape(count, m * d, 1), sides[:states].reshape(count, m * d, 2)]
    k = free + 1
    rows = np.zeros((count, k, m * d))
    foot = np.zeros((k, k + 2))
    if free:
        rows[:, 0] = work.phase
        foot[0] = work.corner, column[states], *sides[states]
        foot[1, 0] = border[states]
    rows[:, -1] = border[:states].reshape(count, m * d)
    foot[-1, k - 1 :] = border[-1], *sides[-1]
    foot[-1, k - 1] += border[tail] @ widths[:, 0]
    foot[-1, k:] -= border[tail] @ widths[:, 1:]
    if work.sparse is not None:
        matrix = work.sparse.closed(work.entries, work.closure)
        outer = np.concatenate(shared, axis=2).reshape(states, -1)
        solved, sign = solve_bordered(
            matrix,
            outer[:, :k],
            rows.transpose(1, 0, 2).reshape(k, states),
            foot[:, :k],
            np.concatenate([outer[:, k:], foot[:, k:]]),
        )
        return _placed(data, solved[:states], solved[states:], widths), sign
    solved = solve_collocation(work.blocks, np.concatenate(shared, axis=2), rows, foot, d, work.closure)
    work.mesh = solved.left, solved.right
    return _placed(data, solved.states.reshape(states, 2), solved.shared, widths), solved.sign


def _placed(data: Collocated, states: np.ndarray, shared: np.ndarray, widths: np.ndarray) -> np.ndarray:
    """Solutions in the order of the unknowns, the parameter last."""
    found = np.empty((data.dimension + 1, 2))
    found[: data.states] = states
    found[data.states : data.states + data.free_period] = shared[: data.free_period]
    found[data.states + data.free_period : -1] = widths[:, 1:] + widths[:, :1] * shared[-1]
    found[-1] = shared[-1]
    return found


def _solve_full(
    work: CycleWork, border: np.ndarray, column: np.ndarray, sides: np.ndarray
) -> tuple[np.ndarray, float]:
    from scipy.sparse import bmat
    from scipy.sparse.linalg import splu

    whole = bmat([[work.full, column[:, None]], [border[None, :-1], border[None, -1:]]], format="csc")
    try:
        return splu(whole).solve(sides), 0.0  # nobody asks for the sign
    except RuntimeError as error:
        raise np.linalg.LinAlgError(str(error)) from error


def condensed(data: Collocated, work: CycleWork) -> tuple[np.ndarray, np.ndarray]:
    """What is left of the equations between neighbouring mesh points, L x_i + R x_(i + 1): L and R, shape (N, d, d), in units of the scales."""
    if work.mesh is None:
        nothing = np.zeros((data.intervals, data.rule.degree * data.node, 0))
        cond = condense(work.blocks, nothing, data.node)
        work.mesh = cond.left, cond.right
    return work.mesh


def spectrum(data: Collocated, work: CycleWork) -> tuple[np.ndarray, float]:
    """Multipliers, of autonomous flows without the trivial one, and by how much that one, as computed, misses 1."""
    if work.sparse is not None:
        points, p, _, _ = work.along
        speed = data.field(points[:1], p)[0] / data.node_scale if data.free_period else None
        return leading_multipliers(work.sparse, work.entries, speed)
    left, right = condensed(data, work)
    if data.n_multipliers == 1:
        # Liouville: stiff parts of a cycle are passed in intervals in which collocation contracts less than the flow does
        value = complex(math.exp(min(max(growth_of_volume(data, work), -LARGEST), LARGEST)))
        found = _across(data, work, left, right)
        return np.array([value]), 0.0 if found is None else abs(found[1] - 1.0)
    if not data.free_period:
        return multipliers_of(left, right), 0.0
    found = _across(data, work, left, right)
    if found is None:  # a cycle that is an equilibrium: all motions are as slow as none
        values = multipliers_of(left, right)
        return np.delete(values, int(np.argmin(np.abs(values - 1.0)))), 0.0
    maps, product = found
    ahead = np.empty_like(maps)
    ahead[:] = -np.eye(maps.shape[1])
    return multipliers_of(maps, ahead), abs(product - 1.0)


def growth_of_volume(data: Collocated, work: CycleWork) -> float:
    """Logarithm of the product of all multipliers: the integral of the trace of the Jacobian over the cycle (Liouville)."""
    _, _, jacobian, _ = work.along
    return float((work.steps[:, None] * data.rule.weights).reshape(-1) @ np.trace(jacobian, axis1=1, axis2=2))


def _across(
    data: Collocated, work: CycleWork, left: np.ndarray, right: np.ndarray
) -> tuple[np.ndarray, float] | None:
    """Maps between the planes across the motion, and the trivial multiplier, as computed; None of forced flows, and where nothing moves."""
    if not data.free_period:
        return None
    points, p, _, _ = work.along
    speeds = data.field(points, p) / data.node_scale
    squares = np.einsum("ij,ij->i", speeds, speeds)
    if not math.sqrt(squares.min()) > data.field.settings.solved * (1.0 + math.sqrt(squares.max())):
        return None
    return (planes if work.core is None else work.core.across)(left, right, speeds)


def planes(left: np.ndarray, right: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, float]:
    """:meth:`contvines.flows.core.CoreCycle.across` in numpy."""
    steps, sizes = -np.linalg.solve(right, left), np.linalg.norm(speeds, axis=1)
    units = speeds / sizes[:, None]
    here = np.linalg.qr(units[:, :, None], mode="complete")[0][:, :, 1:]
    there = np.roll(here, -1, axis=0)
    along = np.einsum("ij,ijk,ik->i", np.roll(units, -1, axis=0), steps, units)
    growth = along * sizes / np.roll(sizes, -1)
    return np.matmul(there.transpose(0, 2, 1), np.matmul(steps, here)), float(np.prod(growth))


def inspect(data: Collocated, u: np.ndarray, p: float, work: CycleWork, row: np.ndarray) -> None:
    """Multipliers, then margins."""
    with np.errstate(all="ignore"):
        try:
            values, data.missed = spectrum(data, work)
        except np.linalg.LinAlgError:
            values = np.full(data.n_multipliers, np.nan + 0j)
        row[: 2 * len(values)].view(np.complex128)[:] = values
        if data.n_margins:
            row[2 * len(values) :] = data.margins(u, work)


def matrix(data: Collocated, work: CycleWork) -> np.ndarray:
    """F_u written out."""
    return full_matrix(data, work) * data.row_scale[:, None] / data.column_scale


def full_matrix(data: Collocated, work: CycleWork) -> np.ndarray:
    """F_u written out, in units of the scales."""
    return _sparse(data, work).toarray()


def _sparse(data: Collocated, work: CycleWork) -> csc_array:
    """F_u as a sparse matrix, in units of the scales."""
    from scipy.sparse import csc_array

    if work.full is not None:
        return work.full
    count, m, d, free = data.intervals, data.rule.degree, data.node, data.free_period
    states, size = count * m * d, data.dimension
    own, wide = m * d, (m + 1) * d
    blocks = work.blocks.copy()
    blocks[-1, :, own:] *= work.closure
    first = own * np.arange(count)[:, None, None]
    rows, columns = np.broadcast_arrays(first + np.arange(own)[:, None], (first + np.arange(wide)) % states)
    tail = np.arange(states + free, size)
    entries = [(blocks, rows, columns), (np.ones(count), tail, tail)]
    if free:
        there, last = np.arange(states), np.full(states, states)
        entries += [(work.by_period, there, last), (work.phase, last, there)]
        entries += [(np.array([work.corner]), last[:1], last[:1])]
    parts = [np.concatenate([np.reshape(entry[k], -1) for entry in entries]) for k in range(3)]
    return csc_array((parts[0], (parts[1], parts[2])), shape=(size, size))


def flip(data: Collocated, work: CycleWork, sign: float) -> None:
    """Turn the closure of the cycle round (sign = -1), and back (sign = 1): no phase and no period belong to such perturbations."""
    work.closure, work.full = sign, None
    if not data.free_period:
        return
    if sign < 0.0:
        work.kept = work.by_period.copy(), work.phase.copy()
        work.by_period[:], work.phase[:] = 0.0, 0.0
    else:
        work.by_period[:], work.phase[:] = work.kept
    work.corner = 1.0 if sign < 0.0 else 0.0


def transpose(data: Collocated, work: CycleWork, column: np.ndarray, other: CycleWork) -> None:
    """The transposed F_u, with another last column, into another workspace."""
    from scipy.sparse import csc_array, diags_array

    # F_u in the user's units, transposed, in units of the scales once more
    sizes = data.row_scale * data.column_scale
    other.full = csc_array(diags_array(1.0 / sizes) @ _sparse(data, work).T @ diags_array(sizes))
    other.derivative[:] = column


KERNELS = Kernels(
    linearise, bordered, inspect, compiled=False, assign=assign, flip=flip, transpose=transpose, column=1, matrix=matrix
)  # fmt: skip

SPARSE = Kernels(linearise, bordered, inspect, compiled=False, assign=assign, column=1)
