"""Continuation loop of compiled problems, in the native core (native/march.hpp)."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import astuple
from functools import cache
from time import perf_counter

import numpy as np

from ..core.library import NUMBER, POINTER, WHOLE, address, function
from ..core.table import memory_of, pack, place
from ..long_work import wanted
from .layout import Aim, Chunk, Control, Found, Metric, Scratch, Status, Way
from .settings import BY_ANGLE, SOLUTION, StepRule

BRIEF, LONG = (
    0.01,
    0.04,
)  # seconds: after shorter calls the next one computes more points, after longer ones fewer; interrupts are noticed between calls

LIMITS = np.array(astuple(SOLUTION))

JUDGE = ctypes.CFUNCTYPE(NUMBER, NUMBER, NUMBER, WHOLE, NUMBER, NUMBER, NUMBER)
ABORT = -np.inf


class Judge:
    """A user-defined step rule as a C function; its exceptions are raised again after the march returns.

    Parameters
    ----------
    rule : StepRule
    """

    def __init__(self, rule: StepRule) -> None:
        self.rule = rule
        self.error: BaseException | None = None
        self.callback = JUDGE(self._call)
        self.address = ctypes.cast(self.callback, ctypes.c_void_p).value

    def _call(self, *numbers: float) -> float:
        try:
            return self.rule.factor(*numbers)
        except BaseException as error:
            self.error = error
            return ABORT

    def raise_again(self) -> None:
        """Raise the exception of the rule, if there was one."""
        error, self.error = self.error, None
        if error is not None:
            raise error


class NativeLoop:
    """March and single points of one problem in the native core.

    Parameters
    ----------
    table : int
        Address of the problem's kernels; see `contvines.core.table`.
    data, work
        Data and workspace of the problem, with ``memory``.
    sizes : (int, int)
        Numbers of unknowns and of entries of a row.
    metric : Metric
        Metric of unknowns with scale 1.
    noise : float
        Noise of the equations.
    known : ndarray
        Bracket of a search; see :mod:`contvines.continuation.layout`.
    scratch : Scratch
    rule : StepRule
    """

    def __init__(
        self,
        table: int,
        data: object,
        work: object,
        sizes: tuple[int, int],
        metric: Metric,
        noise: float,
        bracket: np.ndarray,
        scratch: Scratch,
        rule: StepRule,
    ) -> None:
        self.references = data, work, bracket, scratch
        self.frame = pack(
            table,
            memory_of(data),
            memory_of(work),
            *sizes,
            float(metric.of_unknowns),
            float(metric.of_parameter),
            float(noise),
            *scratch,
            bracket,
            LIMITS,
        )
        self.at = address(self.frame)
        self.judge = None if rule is BY_ANGLE else Judge(rule)
        self.at_once = 4  # number of points of one call

    def march(self, chunk: Chunk, first: int, h: float, control: Control) -> tuple[int, float, int]:
        """Fill rows of a chunk; see :meth:`contvines.continuation.loop.InterpretedLoop.march`."""
        step, filled, status = NUMBER(h), WHOLE(first), Status.RUNNING
        arrays, size, settings = (
            [place(array) for array in chunk.arrays],
            len(chunk.points),
            np.array(control),
        )
        judge = None if self.judge is None else self.judge.address
        while status == Status.RUNNING and filled.value < size and not wanted():
            began = perf_counter()
            status = _march()(
                self.at,
                *arrays,
                filled.value,
                min(filled.value + self.at_once, size),
                ctypes.addressof(step),
                address(settings),
                judge,
                ctypes.addressof(filled),
            )
            if self.judge is not None:
                self.judge.raise_again()
            seconds = perf_counter() - began
            if seconds < BRIEF:
                self.at_once *= 2
            elif seconds > LONG:
                self.at_once = max(self.at_once // 2, 1)
        return filled.value, step.value, status

    def points(self, way: Way, places: np.ndarray, found: Found, aim: Aim) -> int:
        """Solve for the points at some positions, or for the zero of an aim; see :meth:`contvines.continuation.loop.InterpretedLoop.points`."""
        columns = np.ascontiguousarray(aim.columns, dtype=np.int64)
        aimed = pack(aim.test, len(columns), columns, aim.count, aim.kind, aim.sort, aim.rank, aim.anyway)
        return _points()(
            self.at,
            place(way.chord),
            way.start,
            way.length,
            place(places),
            len(places),
            place(way.border),
            place(way.along),
            way.sweeps,
            *map(address, found),
            address(aimed),
        )


@cache
def _march() -> Callable[..., int]:
    return function(
        "core_march", WHOLE, POINTER, *[POINTER] * 6, WHOLE, WHOLE, POINTER, POINTER, POINTER, POINTER
    )


@cache
def _points() -> Callable[..., int]:
    arrays = [POINTER] * 4
    return function(
        "core_points", WHOLE, POINTER, POINTER, NUMBER, NUMBER, POINTER, WHOLE, POINTER, POINTER, WHOLE, *arrays, POINTER
    )  # fmt: skip
