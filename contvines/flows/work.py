"""Workspaces of cycles: collocation equations with phase condition and mesh, and their linear algebra by orthogonal elimination.

`CycleWork` is the reference in numpy, `CoreWork` uses the native core, `SparseWork` is for large flows.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function, native
from ..core.table import pack, place
from . import mesh, sparse
from .elimination import condense, multipliers_of, solve_collocation

if TYPE_CHECKING:
    from scipy.sparse import csc_array

    from ..problems.functions import ParameterSet
    from .at_points import CompiledRates
    from .cycle_mesh import CycleMesh

LARGEST = 707.0  # largest magnitude of a multiplier's logarithm, near the range of floating-point numbers
VARYING = 4  # index of the varying parameter in the struct `Rates`


class CycleWork:
    """Result of a linearisation.

    ``self[0]`` is F and ``self[1]`` is F_p, of the equations and unknowns of :class:`contvines.flows.cycles.CycleProblem`. The other derivatives are
    in units of the scales: ``blocks`` (N, m d, (m + 1) d) by the values at the nodes, ``by_period`` (N, m d) by the period; ``phase`` (N, m d) is the row
    of the phase condition.

    Parameters
    ----------
    problem : CycleMesh
        Determines mesh and scales; problems with other parameter values can share the workspace.
    """

    rates: CoreRates | None = None  # a compiled right-hand side that the native core calls directly

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
        # by_period and phase, while the closure is changed to x_N = -x_0
        self.saved: tuple[np.ndarray, np.ndarray] = nothing, nothing
        self.begin()

    def begin(self) -> None:
        """Discard results of the last linearisation."""
        # condensed equations between neighbouring mesh points
        self.mesh: tuple[np.ndarray, np.ndarray] | None = None
        # for loci: the transposed F_u as a sparse matrix, used instead of the blocks
        self.full: csc_array | None = None
        self.closure, self.corner = 1.0, 0.0

    def __getitem__(self, i: int) -> np.ndarray:
        return (self.residual, self.derivative)[i]

    # ------------------------------------------------------------------ equations
    def at_gauss_points(self, x: np.ndarray) -> np.ndarray:
        """Return the states at the Gauss points, shape (N m, d)."""
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
        """Compute residual, derivatives and phase condition; return the length of the phase condition's row before it is normalised, or NaN if a number is not finite.

        Parameters
        ----------
        x, widths, period
            Values at the nodes (N, m, d), widths (N,), period.
        f, jacobian, slope : ndarray
            f, df/dx and df/dp at the Gauss points, shapes (N m, d), (N m, d, d), (N m, d); slope is None for forced flows.
        """
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
        """Compute the derivatives by the values at the nodes from the durations of the intervals and df/dx at the Gauss points."""
        scale = self.problem.node_scale
        each = np.repeat(steps, self.problem.rule.degree)[:, None, None]
        self.blocks[:] = self.problem.rule.blocks(each * jacobian * (scale / scale[:, None]))

    # ------------------------------------------------------------------ linear algebra
    def bordered(self, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray) -> float:
        """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); return the sign of the determinant."""
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
        """Solve the bordered system, in units of the scales, by elimination: period and parameter are shared columns, phase and border are shared rows."""
        problem = self.problem
        count, states, k = problem.intervals, problem.states, problem.free_period + 1
        inner, tail = states // count, problem.held
        # the rows of the widths are the identity; the columns are the parameter's, then one of each right-hand side
        widths = np.concatenate([-column[tail, None], sides[tail]], axis=1)
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
        shifts = widths[:, 1:] + widths[:, :1] * shared[-1]
        return np.concatenate([nodes.reshape(states, 2), shared[:-1], shifts, shared[-1:]]), sign

    def _solved(
        self, columns: np.ndarray, rows: np.ndarray, foot: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, float]:
        """Solve the collocation equations: values at the nodes, shared unknowns, sign of the determinant."""
        solved = solve_collocation(self.blocks, columns, rows, foot, self.problem.node, self.closure)
        self.mesh = solved.left, solved.right
        return solved.states, solved.shared, solved.sign

    def _factorised(
        self, border: np.ndarray, column: np.ndarray, sides: np.ndarray
    ) -> tuple[np.ndarray, float]:
        from scipy.sparse import bmat
        from scipy.sparse.linalg import splu

        bordered = bmat([[self.full, column[:, None]], [border[None, :-1], border[None, -1:]]], format="csc")
        try:
            return splu(bordered).solve(sides), 0.0  # the sign is not needed for transposed equations
        except RuntimeError as error:
            raise np.linalg.LinAlgError(str(error)) from error

    def matrix(self) -> csc_array:
        """Return F_u as a sparse matrix, in units of the scales."""
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
            indices, last = np.arange(states), np.full(states, states)
            entries += [(self.by_period, indices, last), (self.phase, last, indices)]
            entries += [(np.array([self.corner]), last[:1], last[:1])]
        values, i, j = (np.concatenate([np.ravel(entry[k]) for entry in entries]) for k in range(3))
        return csc_array((values, (i, j)), shape=(size, size))

    def condensed(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the condensed equations between neighbouring mesh points, L x_i + R x_(i + 1): L and R, shape (N, d, d), in units of the scales."""
        if self.mesh is None:
            found = condense(self.blocks, np.zeros((*self.blocks.shape[:2], 0)), self.problem.node)
            self.mesh = found.left, found.right
        return self.mesh

    # ------------------------------------------------------------------ multipliers, distance from equilibria
    def spectrum(self) -> tuple[np.ndarray, float]:
        """Return the multipliers, for autonomous flows without the trivial one, and the distance of the computed trivial one from 1."""
        left, right = self.condensed()
        if not self.problem.free_period and self.problem.n_multipliers > 1:
            return multipliers_of(left, right), 0.0
        found = self._maps_across() if self.problem.free_period else None
        missed = 0.0 if found is None else abs(found[1] - 1.0)
        if self.problem.n_multipliers == 1:
            # by Liouville's formula: in stiff parts of the cycle collocation contracts less than the flow
            value = complex(math.exp(min(max(self.growth_of_volume(), -LARGEST), LARGEST)))
            return np.array([value]), missed
        if found is None:  # the cycle is an equilibrium: there is no plane across its motion
            values = multipliers_of(left, right)
            return np.delete(values, int(np.argmin(np.abs(values - 1.0)))), 0.0
        maps = found[0]
        return multipliers_of(maps, np.broadcast_to(-np.eye(maps.shape[1]), maps.shape)), missed

    def growth_of_volume(self) -> float:
        """Return the logarithm of the product of all multipliers: the integral of the trace of df/dx over the cycle (Liouville)."""
        shares = (self.steps[:, None] * self.problem.rule.weights).reshape(-1)
        return float(shares @ np.trace(self.along[2], axis1=1, axis2=2))

    def _maps_across(self) -> tuple[np.ndarray, float] | None:
        """Maps between the planes across the motion, and the computed trivial multiplier; None if the cycle is an equilibrium."""
        points, p, _, _ = self.along
        field = self.problem.field
        speeds = field(points, p) / self.problem.node_scale
        squares = np.einsum("ij,ij->i", speeds, speeds)
        if not math.sqrt(squares.min()) > field.settings.solved * (1.0 + math.sqrt(squares.max())):
            return None
        return self.planes(*self.condensed(), speeds)

    def planes(self, left: np.ndarray, right: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, float]:
        """Return the maps between the planes across the motion at successive mesh points, (N, d - 1, d - 1), and the computed trivial multiplier.

        The latter is the factor by which a perturbation along the motion grows over the cycle.

        Raises
        ------
        LinAlgError
            If an interval's equations are singular.
        """
        steps, sizes = -np.linalg.solve(right, left), np.linalg.norm(speeds, axis=1)
        units = speeds / sizes[:, None]
        plane = np.linalg.qr(units[:, :, None], mode="complete")[0][:, :, 1:]
        next_plane = np.roll(plane, -1, axis=0)
        along = np.einsum("ij,ijk,ik->i", np.roll(units, -1, axis=0), steps, units)
        growth = along * sizes / np.roll(sizes, -1)
        return np.matmul(next_plane.transpose(0, 2, 1), np.matmul(steps, plane)), float(np.prod(growth))

    def distance_to_rest(self) -> float:
        """Return the length of the shortest Newton step to an equilibrium from the Gauss points, in units of the scale; infinite if there is none."""
        _, _, jacobian, f = self.along
        scale = self.problem.node_scale
        return distance_to_rest(jacobian * (scale / scale[:, None]), f / scale)


def distance_to_rest(matrices: np.ndarray, rates: np.ndarray) -> float:
    """Return the length of the shortest Newton step to an equilibrium from points with Jacobians (n, d, d) and rates (n, d); infinite if there is none."""
    try:
        steps = np.linalg.solve(matrices, rates[..., None])[..., 0]
    except np.linalg.LinAlgError:  # one of them is singular to the last bit
        steps = np.matmul(np.linalg.pinv(matrices), rates[..., None])[..., 0]
    sizes = np.sqrt((steps**2).sum(axis=-1))
    return float(np.nanmin(sizes)) if np.isfinite(sizes).any() else np.inf


class SparseWork(CycleWork):
    """Workspace of large flows with a sparse Jacobian; ``entries`` are the derivatives by the values at the nodes."""

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
        """Return the leading multipliers, and the distance of the computed trivial one from 1."""
        points, p, _, _ = self.along
        problem = self.problem
        speed = problem.field(points[:1], p)[0] / problem.node_scale if problem.free_period else None
        return sparse.leading_multipliers(self.equations, self.entries, speed)

    def distance_to_rest(self) -> float:
        """Return the length of the Newton step to an equilibrium from the slowest of the Gauss points."""
        _, _, jacobian, f = self.along
        return sparse.distance_to_rest(self.equations.pattern, jacobian, f, self.problem.node_scale)


class CoreRates:
    """A compiled right-hand side of an autonomous flow, with all its derivatives, at n Gauss points of d states, with q parameters."""

    def __init__(self, compiled: CompiledRates, q: int, n: int, d: int) -> None:
        self.compiled = compiled
        self.parameters, self.f, self.jacobian = np.empty(q), np.empty((n, d)), np.empty((n, d, d))
        self.slopes, self.slope = np.empty((n, d, q)), np.empty((n, d))
        arrays = self.parameters, self.f, self.jacobian, self.slopes, self.slope
        self.record = pack(*compiled.addresses, q, 0, *arrays)

    def assign(self, values: ParameterSet, p: float) -> None:
        """Set the varying parameter and all values; needed before each evaluation, since problems with different varying parameters share a workspace (loci)."""
        varying = list(values.values).index(values.varying)
        self.parameters[:] = [*values.values.values()]
        self.parameters[varying] = p
        self.record[VARYING] = varying


class CoreWork(CycleWork):
    """Workspace of the native core: the functions of native/collocation.hpp fill the same arrays."""

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
        # references keep the arrays alive: the record has their addresses
        self.arrays = rules, own, elimination
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
        """Return the states at the Gauss points, in an array that the next call overwrites."""
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
        """As :meth:`CycleWork.assemble`, for the states of the last call of `at_gauss_points`."""
        by = None if slope is None else np.ascontiguousarray(slope, dtype=float)
        return self._assemble(
            self.at, place(widths), period, place(f), place(jacobian), None if by is None else address(by)
        )

    def evaluate(self, x: np.ndarray, widths: np.ndarray, period: float, rates: CoreRates) -> float:
        """Evaluate a compiled right-hand side at the Gauss points, and `assemble`."""
        x = np.ascontiguousarray(x, dtype=float)
        return self._evaluate(self.at, address(rates.record), address(x), place(widths), period)

    def bordered(self, border: np.ndarray, n: float, step: np.ndarray, tangent: np.ndarray) -> float:
        """Solve [[F_u, F_p], [border]] x = (-F, n) and (0, 1); return the sign of the determinant."""
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
        """As :meth:`CycleWork.distance_to_rest`; if a Jacobian is singular, numpy computes it."""
        _, _, jacobian, f = self.along
        found = self._distance(self.at, place(f), place(jacobian))
        return found if found >= 0.0 else super().distance_to_rest()


def workspace(problem: CycleMesh) -> CycleWork:
    """Return the workspace for a problem of cycles."""
    if problem.sparse is not None:
        return SparseWork(problem, problem.sparse)
    return CoreWork(problem) if native() else CycleWork(problem)
