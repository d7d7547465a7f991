"""Workspaces of cycles: collocation equations with phase and mesh, and their linear algebra by orthogonal elimination.

`CycleWork` in numpy, the reference; `CoreWork` in the native core; `SparseWork` of large flows.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function, native
from ..core.records import pack, place
from . import mesh, sparse
from .elimination import condense, multipliers_of, solve_collocation

if TYPE_CHECKING:
    from scipy.sparse import csc_array

    from ..problems.functions import ParameterSet
    from .at_points import CompiledRates
    from .cycle_mesh import CycleMesh

LARGEST = 707.0  # logarithms of multipliers are clamped here, where floats end
VARYING = 4  # place of the parameter that varies in the struct `Rates`


class CycleWork:
    """What a linearisation leaves behind, in units of the scales.

    ``self[0]`` is F, ``self[1]`` is F_p. Equations and unknowns are those of :class:`contvines.flows.cycles.CycleProblem`.
    ``blocks`` (N, m d, (m + 1) d) are the derivatives of the collocation equations by the values at the nodes, ``by_period`` (N, m d) those
    by the period, ``phase`` (N, m d) the row of the phase condition.

    Parameters
    ----------
    problem : CycleMesh
        Whose discretisation and scales it is; those with other values of the parameters share it.
    """

    rates: CoreRates | None = None  # a right-hand side that the core calls by itself

    def __init__(self, problem: CycleMesh) -> None:
        self.problem = problem
        self.residual, self.derivative = np.zeros(problem.dimension), np.zeros(problem.dimension)
        count, inner = problem.intervals, problem.rule.degree * problem.node
        shape = (2, count, inner) if problem.free_period else (2, 0)
        self.by_period, self.phase = np.zeros(shape)
        self.blocks = np.zeros((count, inner, inner + problem.node) if problem.sparse is None else 0)
        self.steps = np.zeros(0)  # lengths of the intervals in time
        # mesh points, parameter, Jacobians and rates at the Gauss points
        nothing = np.zeros(0)
        self.along: tuple[np.ndarray, float, np.ndarray, np.ndarray] = nothing, math.nan, nothing, nothing
        self.kept: tuple[np.ndarray, np.ndarray] = (
            nothing,
            nothing,
        )  # by_period and phase, while the closure is turned round
        self.begin()

    def begin(self) -> None:
        """Forget what belonged to the last linearisation."""
        # what is left of the equations between neighbouring mesh points
        self.mesh: tuple[np.ndarray, np.ndarray] | None = None
        # F_u as a sparse matrix in the place of its blocks, where it has been transposed (loci)
        self.full: csc_array | None = None
        self.closure, self.corner = 1.0, 0.0

    def __getitem__(self, i: int) -> np.ndarray:
        return (self.residual, self.derivative)[i]

    # ------------------------------------------------------------------ equations
    def at_gauss_points(self, x: np.ndarray) -> np.ndarray:
        """The states at the Gauss points, shape (N m, d)."""
        return mesh.at_gauss_points(self.problem.rule.values, x)

    def assemble(
        self,
        x: np.ndarray,
        widths: np.ndarray,
        period: float,
        f: np.ndarray,
        jacobian: np.ndarray,
        slope: np.ndarray | None,
    ) -> float:
        """Residual, derivatives and phase condition; returns the length that the row of the phase condition had, NaN where a number is not finite."""
        problem = self.problem
        r, scale, states = problem.rule, problem.node_scale, problem.states
        if not math.isfinite(f.sum() + jacobian.sum() + (0.0 if slope is None else slope.sum())):
            return math.nan
        steps = np.repeat(period * widths, r.degree)[:, None]
        self._fill(period * widths, jacobian)
        self.residual[:], self.derivative[:] = 0.0, 0.0
        self.residual[:states] = (mesh.at_gauss_points(r.slopes, x) - steps * f).reshape(-1)
        if slope is None:
            return 0.0
        self.derivative[:states] = -(steps * slope).reshape(-1)
        direction = (f / scale).reshape(x.shape)
        self.by_period[:] = -(widths[:, None, None] * direction * problem.clock).reshape(self.phase.shape)
        self.phase[:], size = mesh.phase_row(r, widths, direction)
        return size

    def _fill(self, steps: np.ndarray, jacobian: np.ndarray) -> None:
        """Derivatives by the nodes, from the lengths of the intervals and df/dx at the Gauss points."""
        scale = self.problem.node_scale
        each = np.repeat(steps, self.problem.rule.degree)[:, None, None]
        self.blocks[:] = self.problem.rule.blocks(each * jacobian * (scale / scale[:, None]))

    # ------------------------------------------------------------------ linear algebra
    def bordered(self, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray) -> float:
        """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); returns the sign of the determinant."""
        problem = self.problem
        columns = np.append(problem.column_scale, problem.parameter_scale)
        sides = np.zeros((len(border), 2))
        sides[:-1, 0], sides[-1] = -self.residual / problem.row_scale, (n, 1.0)
        column = self.derivative / problem.row_scale * problem.parameter_scale
        solve = self._eliminated if self.full is None else self._factorised
        with np.errstate(all="ignore"):
            try:
                found, sign = solve(border * columns, column, sides)
            except np.linalg.LinAlgError:
                step[:], tangent[:] = np.nan, np.nan
                return 0.0
        step[:], tangent[:] = (found * columns[:, None]).T
        return sign

    def _eliminated(
        self, border: np.ndarray, column: np.ndarray, sides: np.ndarray
    ) -> tuple[np.ndarray, float]:
        """In units of the scales: what is shared by all intervals is a border of the equations at the Gauss points."""
        problem = self.problem
        count, states, k = problem.intervals, problem.states, problem.free_period + 1
        inner, tail = states // count, problem.held
        # the mesh keeps its widths: those rows are the identity
        widths = np.concatenate(
            [-column[tail, None], sides[tail]], axis=1
        )  # by the parameter, then of each side
        columns = np.empty((count, inner, k + 2))
        rows, foot = np.zeros((count, k, inner)), np.zeros((k, k + 2))
        if k == 2:
            columns[:, :, 0], rows[:, 0] = self.by_period, self.phase
            foot[0] = self.corner, column[states], *sides[states]
            foot[1, 0] = border[states]
        columns[:, :, k - 1] = column[:states].reshape(count, inner)
        columns[:, :, k:] = sides[:states].reshape(count, inner, 2)
        rows[:, -1] = border[:states].reshape(count, inner)
        foot[-1, k - 1 :] = border[-1], *sides[-1]
        foot[-1, k - 1] += border[tail] @ widths[:, 0]
        foot[-1, k:] -= border[tail] @ widths[:, 1:]
        nodes, shared, sign = self._solved(columns, rows, foot)
        moved = widths[:, 1:] + widths[:, :1] * shared[-1]
        return np.concatenate([nodes.reshape(states, 2), shared[:-1], moved, shared[-1:]]), sign

    def _solved(
        self, columns: np.ndarray, rows: np.ndarray, foot: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, float]:
        """Values at the nodes, shared unknowns, sign of the determinant."""
        solved = solve_collocation(self.blocks, columns, rows, foot, self.problem.node, self.closure)
        self.mesh = solved.left, solved.right
        return solved.states, solved.shared, solved.sign

    def _factorised(
        self, border: np.ndarray, column: np.ndarray, sides: np.ndarray
    ) -> tuple[np.ndarray, float]:
        from scipy.sparse import bmat
        from scipy.sparse.linalg import splu

        whole = bmat([[self.full, column[:, None]], [border[None, :-1], border[None, -1:]]], format="csc")
        try:
            return splu(whole).solve(sides), 0.0  # nobody asks for the sign
        except RuntimeError as error:
            raise np.linalg.LinAlgError(str(error)) from error

    def matrix(self) -> csc_array:
        """F_u as a sparse matrix, in units of the scales."""
        from scipy.sparse import csc_array

        if self.full is not None:
            return self.full
        problem, blocks = self.problem, self.blocks.copy()
        states, size, own = problem.states, problem.dimension, blocks.shape[1]
        blocks[-1, :, own:] *= self.closure
        first = own * np.arange(len(blocks))[:, None, None]
        rows, columns = np.broadcast_arrays(
            first + np.arange(own)[:, None], (first + np.arange(blocks.shape[2])) % states
        )
        tail = np.arange(size)[problem.held]
        entries = [(blocks, rows, columns), (np.ones(len(tail)), tail, tail)]
        if problem.free_period:
            there, last = np.arange(states), np.full(states, states)
            entries += [(self.by_period, there, last), (self.phase, last, there)]
            entries += [(np.array([self.corner]), last[:1], last[:1])]
        values, i, j = (np.concatenate([np.ravel(entry[k]) for entry in entries]) for k in range(3))
        return csc_array((values, (i, j)), shape=(size, size))

    def condensed(self) -> tuple[np.ndarray, np.ndarray]:
        """What is left of the equations between neighbouring mesh points, L x_i + R x_(i + 1): L and R, shape (N, d, d), in units of the scales."""
        if self.mesh is None:
            found = condense(self.blocks, np.zeros((*self.blocks.shape[:2], 0)), self.problem.node)
            self.mesh = found.left, found.right
        return self.mesh

    # ------------------------------------------------------------------ what is known of the motions beside the cycle
    def spectrum(self) -> tuple[np.ndarray, float]:
        """Multipliers, of autonomous flows without the trivial one, and by how much that one, as computed, misses 1."""
        left, right = self.condensed()
        if not self.problem.free_period and self.problem.n_multipliers > 1:
            return multipliers_of(left, right), 0.0
        found = self._across() if self.problem.free_period else None
        missed = 0.0 if found is None else abs(found[1] - 1.0)
        if self.problem.n_multipliers == 1:
            # Liouville: stiff parts of a cycle are passed in intervals in which collocation contracts less than the flow does
            value = complex(math.exp(min(max(self.growth_of_volume(), -LARGEST), LARGEST)))
            return np.array([value]), missed
        if found is None:  # a cycle that is an equilibrium: all motions are as slow as none
            values = multipliers_of(left, right)
            return np.delete(values, int(np.argmin(np.abs(values - 1.0)))), 0.0
        maps = found[0]
        return multipliers_of(maps, np.broadcast_to(-np.eye(maps.shape[1]), maps.shape)), missed

    def growth_of_volume(self) -> float:
        """Logarithm of the product of all multipliers: the integral of the trace of the Jacobian over the cycle (Liouville)."""
        shares = (self.steps[:, None] * self.problem.rule.weights).reshape(-1)
        return float(shares @ np.trace(self.along[2], axis1=1, axis2=2))

    def _across(self) -> tuple[np.ndarray, float] | None:
        """Maps between the planes across the motion, and the trivial multiplier, as computed; None where nothing moves."""
        points, p, _, _ = self.along
        field = self.problem.field
        speeds = field(points, p) / self.problem.node_scale
        squares = np.einsum("ij,ij->i", speeds, speeds)
        if not math.sqrt(squares.min()) > field.settings.solved * (1.0 + math.sqrt(squares.max())):
            return None
        return self.planes(*self.condensed(), speeds)

    def planes(self, left: np.ndarray, right: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, float]:
        """Maps from each mesh point to the next one between the planes across the motion, (N, d - 1, d - 1), and the factor by which the
        direction of motion grows round the cycle: the trivial multiplier, as computed.

        Raises
        ------
        LinAlgError
            If an interval's equations are singular.
        """
        steps, sizes = -np.linalg.solve(right, left), np.linalg.norm(speeds, axis=1)
        units = speeds / sizes[:, None]
        here = np.linalg.qr(units[:, :, None], mode="complete")[0][:, :, 1:]
        there = np.roll(here, -1, axis=0)
        along = np.einsum("ij,ijk,ik->i", np.roll(units, -1, axis=0), steps, units)
        growth = along * sizes / np.roll(sizes, -1)
        return np.matmul(there.transpose(0, 2, 1), np.matmul(steps, here)), float(np.prod(growth))

    def distance_to_rest(self) -> float:
        """The shortest Newton step to an equilibrium from the Gauss points, in units of the scale; infinite if there is none."""
        _, _, jacobian, f = self.along
        scale = self.problem.node_scale
        return distance_to_rest(jacobian * (scale / scale[:, None]), f / scale)


def distance_to_rest(matrices: np.ndarray, rates: np.ndarray) -> float:
    """The shortest Newton step to an equilibrium from points with Jacobians (n, d, d) and rates (n, d); infinite if there is none."""
    try:
        steps = np.linalg.solve(matrices, rates[..., None])[..., 0]
    except np.linalg.LinAlgError:  # one of them is singular to the last bit
        steps = np.matmul(np.linalg.pinv(matrices), rates[..., None])[..., 0]
    sizes = np.sqrt((steps**2).sum(axis=-1))
    return float(np.nanmin(sizes)) if np.isfinite(sizes).any() else np.inf


class SparseWork(CycleWork):
    """Of large flows whose Jacobian is sparse: ``entries`` are those of the derivatives by the nodes."""

    def __init__(self, problem: CycleMesh, equations: sparse.SparseEquations) -> None:
        super().__init__(problem)
        self.equations, self.entries = equations, np.zeros(0)

    def _fill(self, steps: np.ndarray, jacobian: np.ndarray) -> None:
        self.entries = self.equations.entries(steps, jacobian, self.problem.node_scale)

    def _solved(
        self, columns: np.ndarray, rows: np.ndarray, foot: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, float]:
        k, states = len(foot), self.problem.states
        outer = columns.reshape(states, -1)
        found, sign = sparse.solve_bordered(
            self.equations.closed(self.entries, self.closure),
            outer[:, :k],
            rows.transpose(1, 0, 2).reshape(k, states),
            foot[:, :k],
            np.concatenate([outer[:, k:], foot[:, k:]]),
        )
        return found[:states], found[states:], sign

    def spectrum(self) -> tuple[np.ndarray, float]:
        """The leading ones."""
        points, p, _, _ = self.along
        problem = self.problem
        speed = problem.field(points[:1], p)[0] / problem.node_scale if problem.free_period else None
        return sparse.leading_multipliers(self.equations, self.entries, speed)

    def distance_to_rest(self) -> float:
        """From the slowest of the Gauss points."""
        _, _, jacobian, f = self.along
        return sparse.distance_to_rest(self.equations.pattern, jacobian, f, self.problem.node_scale)


class CoreRates:
    """A compiled right-hand side of an autonomous flow, with all its derivatives, at n Gauss points of d states, with q parameters."""

    def __init__(self, compiled: CompiledRates, q: int, n: int, d: int) -> None:
        self.kept = compiled
        self.parameters, self.f, self.jacobian = np.empty(q), np.empty((n, d)), np.empty((n, d, d))
        self.slopes, self.slope = np.empty((n, d, q)), np.empty((n, d))
        arrays = self.parameters, self.f, self.jacobian, self.slopes, self.slope
        self.record = pack(*compiled.addresses, q, 0, *arrays)

    def assign(self, values: ParameterSet, p: float) -> None:
        """Say which parameter varies, and give all of them their values: problems over several parameters share a workspace (loci)."""
        varying = list(values.values).index(values.varying)
        self.parameters[:] = [*values.values.values()]
        self.parameters[varying] = p
        self.record[VARYING] = varying


class CoreWork(CycleWork):
    """In the native core: calls of native/collocation.hpp that fill the same arrays."""

    def __init__(self, problem: CycleMesh) -> None:
        super().__init__(problem)
        r, count, d, k = problem.rule, problem.intervals, problem.node, problem.free_period + 1
        m = r.degree
        compiled = problem.field.compiled
        if compiled is not None and compiled.complete and problem.free_period:
            self.rates = CoreRates(compiled, len(problem.values.values), count * m, d)
        self.points, rates = np.empty((2, count * m, d))
        room = function("core_collocation_room", WHOLE, *[WHOLE] * 5)(count, (m - 1) * d, d, k, 2)
        self.left, self.right = np.empty((2, count, d, d))
        elimination = [
            np.empty((count, m * d, k + 2)),
            np.empty((count, k, m * d)),
            np.zeros((k, k + 2)),
            self.left,
            self.right,
            np.empty((count, m * d, 2)),
            np.empty((k, 2)),
            np.empty(room),
        ]
        own = [
            self.points,
            rates,
            self.residual,
            self.derivative,
            self.blocks,
            self.by_period,
            self.phase,
        ]
        rules = [r.values, r.slopes, r.weights, np.array(problem.node_scale)]
        numbers = problem.clock, problem.parameter_scale
        self.arrays = rules, own, elimination  # kept as long as the record points to them
        self.record = pack(count, m, d, problem.free_period, *rules, *numbers, *own, *elimination)
        self.at = address(self.record)
        self._points = function("core_cycle_points", NOTHING, POINTER, POINTER)
        self._assemble = function("core_cycle_assemble", NUMBER, POINTER, POINTER, NUMBER, *[POINTER] * 3)
        self._evaluate = function("core_cycle_evaluate", NUMBER, POINTER, POINTER, POINTER, POINTER, NUMBER)
        self._bordered = function(
            "core_cycle_bordered", NUMBER, POINTER, NUMBER, NUMBER, POINTER, NUMBER, *[POINTER] * 2
        )
        self._distance = function("core_cycle_distance_to_rest", NUMBER, *[POINTER] * 3)
        self._planes = function("core_cycle_across", NUMBER, *[POINTER] * 3)

    def at_gauss_points(self, x: np.ndarray) -> np.ndarray:
        """In an array that is used again."""
        x = np.ascontiguousarray(x, dtype=float)
        self._points(self.at, address(x))
        return self.points

    def assemble(
        self,
        x: np.ndarray,
        widths: np.ndarray,
        period: float,
        f: np.ndarray,
        jacobian: np.ndarray,
        slope: np.ndarray | None,
    ) -> float:
        """Of the states that were asked for at the Gauss points last."""
        by = None if slope is None else np.ascontiguousarray(slope, dtype=float)
        return self._assemble(
            self.at, place(widths), period, place(f), place(jacobian), None if by is None else address(by)
        )

    def evaluate(self, x: np.ndarray, widths: np.ndarray, period: float, rates: CoreRates) -> float:
        """`assemble` with what a compiled right-hand side gives at the Gauss points."""
        x = np.ascontiguousarray(x, dtype=float)
        return self._evaluate(self.at, address(rates.record), address(x), place(widths), period)

    def bordered(self, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray) -> float:
        """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); returns the sign of the determinant."""
        if self.full is not None:
            return super().bordered(border, n, step, tangent)
        self.mesh = self.left, self.right
        border = np.ascontiguousarray(border, dtype=float)
        places = address(border), n, place(step), place(tangent)
        return self._bordered(self.at, self.closure, self.corner, *places)

    def planes(self, left: np.ndarray, right: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, float]:
        """See :meth:`CycleWork.planes`."""
        self.left[:], self.right[:] = left, right
        count, d = speeds.shape
        maps, speeds = np.empty((count, d - 1, d - 1)), np.ascontiguousarray(speeds, dtype=float)
        product = self._planes(self.at, place(speeds), place(maps))
        if product == -1.0:
            raise np.linalg.LinAlgError("the equations of an interval are singular")
        return maps, product

    def distance_to_rest(self) -> float:
        """Where a Jacobian is singular, in numpy."""
        _, _, jacobian, f = self.along
        found = self._distance(self.at, place(f), place(jacobian))
        return found if found >= 0.0 else super().distance_to_rest()


def workspace(problem: CycleMesh) -> CycleWork:
    """The workspace for a problem of cycles."""
    if problem.sparse is not None:
        return SparseWork(problem, problem.sparse)
    return CoreWork(problem) if native() else CycleWork(problem)
