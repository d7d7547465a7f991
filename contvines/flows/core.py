"""Cycles in the native core: arrays of one workspace, and the calls that fill them (native/collocation.hpp)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from ..core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function
from ..core.records import pack, place

if TYPE_CHECKING:
    from ..problems.functions import ParameterSet
    from .collocation import Rule
    from .compiled import CompiledRates


class Discretised(Protocol):
    """What is read of the problem of cycles."""

    clock: float
    free_period: int
    intervals: int
    node: int
    node_scale: np.ndarray
    parameter_scale: float
    rule: Rule


class Filled(Protocol):
    """The arrays of a workspace that are filled."""

    residual: np.ndarray
    derivative: np.ndarray
    blocks: np.ndarray
    by_period: np.ndarray
    phase: np.ndarray


VARYING = 4  # place of the parameter that varies in the struct `Rates`


class CoreRates:
    """A compiled right-hand side of an autonomous flow at the Gauss points of one workspace.

    Parameters
    ----------
    compiled : CompiledRates
        With all its derivatives.
    q : int
        Parameters.
    n, d : int
        Gauss points, states.
    """

    def __init__(self, compiled: CompiledRates, q: int, n: int, d: int) -> None:
        self.kept = compiled
        self.parameters, self.f, self.jacobian = np.empty(q), np.empty((n, d)), np.empty((n, d, d))
        self.slopes, self.slope = np.empty((n, d, q)), np.empty((n, d))
        arrays = self.parameters, self.f, self.jacobian, self.slopes, self.slope
        self.record = pack(*compiled.addresses, q, 0, *arrays)
        self.at = address(self.record)

    def assign(self, values: ParameterSet, p: float) -> None:
        """Say which parameter varies, and give all of them their values: problems over several parameters share a workspace (loci)."""
        varying = list(values.values).index(values.varying)
        self.parameters[:] = [*values.values.values()]
        self.parameters[varying] = p
        self.record[VARYING] = varying


class CoreCycle:
    """Arrays of one workspace and their addresses.

    Parameters
    ----------
    data : CycleProblem
    work : CycleWork
        Its arrays are those that are filled.
    """

    def __init__(self, data: Discretised, work: Filled) -> None:
        r, count, d = data.rule, data.intervals, data.node
        m, k = r.degree, data.free_period + 1
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
        own = [self.points, rates, work.residual, work.derivative, work.blocks, work.by_period, work.phase]
        rules = [r.values, r.slopes, r.weights, np.array(data.node_scale)]
        self.unit = data.parameter_scale
        numbers = float(data.clock), float(data.parameter_scale)
        self.kept = rules, own, elimination
        self.record = pack(count, m, d, data.free_period, *rules, *numbers, *own, *elimination)
        self.at = address(self.record)
        self._points = function("core_cycle_points", NOTHING, POINTER, POINTER)
        self._assemble = function("core_cycle_assemble", NUMBER, POINTER, POINTER, NUMBER, *[POINTER] * 3)
        self._evaluate = function("core_cycle_evaluate", NUMBER, POINTER, POINTER, POINTER, POINTER, NUMBER)
        self._bordered = function(
            "core_cycle_bordered", NUMBER, POINTER, NUMBER, NUMBER, POINTER, NUMBER, *[POINTER] * 2
        )
        self._distance = function("core_cycle_distance_to_rest", NUMBER, *[POINTER] * 3)
        self._across = function("core_cycle_across", NUMBER, *[POINTER] * 3)

    def at_gauss_points(self, x: np.ndarray) -> np.ndarray:
        """The states at the Gauss points, shape (N m, d), in an array that is used again."""
        x = np.ascontiguousarray(x, dtype=float)
        self._points(self.at, address(x))
        return self.points

    def assemble(
        self, widths: np.ndarray, period: float, f: np.ndarray, jacobian: np.ndarray, slope: np.ndarray | None
    ) -> float:
        """Residual, derivatives and phase condition; returns the length that the row of the phase condition had, NaN where a number is not finite."""
        by = None if slope is None else np.ascontiguousarray(slope, dtype=float)
        return self._assemble(
            self.at, place(widths), period, place(f), place(jacobian), None if by is None else address(by)
        )

    def evaluate(
        self,
        rates: CoreRates,
        values: ParameterSet,
        x: np.ndarray,
        widths: np.ndarray,
        period: float,
        p: float,
    ) -> float:
        """`assemble` with what a compiled right-hand side gives at the Gauss points."""
        rates.assign(values, p)
        x = np.ascontiguousarray(x, dtype=float)
        return self._evaluate(self.at, rates.at, address(x), place(widths), period)

    def bordered(
        self,
        closure: float,
        corner: float,
        border: np.ndarray,
        n: float,
        step: np.ndarray,
        tangent: np.ndarray,
    ) -> float:
        """See :func:`contvines.flows.kernels.bordered`."""
        border = np.ascontiguousarray(border, dtype=float)
        return self._bordered(self.at, closure, corner, address(border), n, place(step), place(tangent))

    def distance_to_rest(self, jacobian: np.ndarray, rates: np.ndarray) -> float | None:
        """The shortest Newton step to an equilibrium from the Gauss points, in units of the scale; None where a Jacobian is singular."""
        found = self._distance(self.at, place(rates), place(jacobian))
        return found if found >= 0.0 else None

    def across(self, left: np.ndarray, right: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, float]:
        """Maps from each mesh point to the next one between the planes across the motion, (N, d - 1, d - 1), and the factor by which the
        direction of motion grows round the cycle: the trivial multiplier, as computed.

        Raises
        ------
        LinAlgError
            If an interval's equations are singular.
        """
        self.left[:], self.right[:] = left, right
        count, d = speeds.shape
        maps, speeds = np.empty((count, d - 1, d - 1)), np.ascontiguousarray(speeds, dtype=float)
        product = self._across(self.at, place(speeds), place(maps))
        if product == -1.0:
            raise np.linalg.LinAlgError("the equations of an interval are singular")
        return maps, product
