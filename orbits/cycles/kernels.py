"""The compiled functions of each model, put together once: maps, elimination, multipliers, margins.

`assemble(model)` returns the kernels that a continuation loop calls (`linearise`, `bordered`, `inspect`) and the two
entry points that this package calls itself (`newton`, `examine`), which call them by address: these are compiled once for all models.
"""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numba import types

from contvines_ground.by_address import NUMBER, VECTOR, WHOLE, own_digest
from contvines_ground.outlined import callers, outlined
from contvines_ground.parts import from_python
from orbits.compiling import arguments, trigonometry
from orbits.compiling import decorators as compiling
from orbits.compiling.decorators import specialise
from orbits.compiling.interrupts import kept_back
from orbits.compiling.waiting import wait_for
from orbits.elimination import block_cyclic, by_address, closure, rearranged, two_unknowns, vectorised
from orbits.machines import path
from orbits.machines.base import Model
from orbits.multipliers import (
    factors,
    periodic_qr,
    periodic_schur,
    product_of_any,
    product_of_two,
    small_eigenvalues,
)
from orbits.words.alphabet import CODES

STICK, SLIP = CODES["s"], CODES["u"]

# filled in per model by `specialise`
linearise: Any = None
bordered: Any = None
margins: Any = None
unpin: Any = None
inspect: Any = None
multipliers: Any = None


def _inspect(data, u, p, work, row):
    """Multipliers of the closure map as (re, im) pairs, then four margins per node, into `row`."""
    unpin(data, work)
    A, D, re, im, scratch = work.A, work.D, work.re, work.im, work.scratch
    events, twist, length = data.events, data.twist, A.shape[0]
    for i in range(length):
        # Nothing later depends on when a stick begins or ends: w' = 0 there and v'' is the same before and after, at a slip
        # w'' = 0, too. Those phases move with 1/w'' and one over the rate at which friction gives way, which grow without
        # bound where the stick vanishes, so they are held instead.
        arrival = events[(i + 1) % length]
        if arrival in (STICK, SLIP):
            A[i, 0, :] = 0.0
            D[i, 0, :] = 0.0
            D[i, 0, 0] = 1.0
    multipliers(A, D, twist, re, im, scratch)
    n = re.size
    count = n
    if (
        data.pinned != 0
    ):  # an impact-free motion may be moved as a whole: drop that multiplier, nearest to the twist
        count = n - 1
        trivial = 0
        for j in range(1, n):
            if np.hypot(re[j] - twist, im[j]) < np.hypot(re[trivial] - twist, im[trivial]):
                trivial = j
        for j in range(trivial, count):
            re[j] = re[j + 1]
            im[j] = im[j + 1]
    for j in range(count):
        row[2 * j] = re[j]
        row[2 * j + 1] = im[j]
    margins(data, u, p, work, row[2 * count :])


def _bordered(data, work, border, target, step, tangent):
    return bordered(data, work, border, target, step, tangent)


def _newton(kernels, at, u, p, trial, border, step, tangent, tolerance, limit):
    """See `Kernels.newton`; `kernels` are addresses, `at` is that of data and workspace."""
    size = u.size
    residual = linearise(kernels, u, p, at)
    for iteration in range(limit):
        sign = bordered(kernels, at, border, 0.0, step, tangent)
        if sign == 0.0 or not np.isfinite(step[0]):
            return np.inf, iteration, p
        length = 0.0
        for j in range(size):
            length = max(length, abs(step[j]))
        share = 1.0
        best = np.inf
        while share > 0.01:
            for j in range(size):
                trial[j] = u[j] + share * step[j]
            best = linearise(kernels, trial, p + share * step[size], at)
            if best < residual or length < 1e-7:
                break
            share *= 0.5
        for j in range(size):
            u[j] = trial[j]
        p += share * step[size]
        residual = best
        if length * share < tolerance or (residual < 1e-14 and length < 1e-9):
            return residual, iteration + 1, p
    return np.inf, limit, p


def _examine(kernels, at, u, p, row):
    """See `Kernels.examine`."""
    residual = linearise(kernels, u, p, at)
    inspect(kernels, u, p, at, row)
    return residual


@cache
def _solvers() -> tuple[Any, Any]:
    """`_newton` and `_examine`, compiled for kernels at any address."""
    own = Path(__file__).read_bytes() + own_digest().encode()
    stamp = hashlib.blake2b(own, digest_size=6).hexdigest()
    addresses = types.UniTuple(WHOLE, 3)
    known: dict[str, Any] = callers()
    newton: Any = specialise(_newton, stamp, **known)
    newton.compile((addresses, WHOLE, VECTOR, NUMBER, VECTOR, VECTOR, VECTOR, VECTOR, NUMBER, WHOLE))
    examine: Any = specialise(_examine, stamp, **known)
    examine.compile((addresses, WHOLE, VECTOR, NUMBER, VECTOR))
    for solver in (newton, examine):
        solver.disable_compile()  # for other types: they would be taken for these at the address
    return newton, examine


class Kernels:
    """The compiled functions of one model.

    Attributes
    ----------
    linearise, bordered, inspect : compiled functions
        What a continuation loop calls: `linearise(data, u, p, work)`, `bordered(data, work, border, target, step,
        tangent)`, `inspect(data, u, p, work, row)`.
    assign, flip, transpose : compiled functions
        What loci against a second parameter need: `assign(data, other, value)` of `orbits.machines.path`, `flip(data, work,
        sign)` and `transpose(data, work, column, other)` of `orbits.elimination.rearranged`.
    column : int
        Place of F_p in a workspace.
    matrix : callable
        `matrix(data, work)`, the whole Jacobian.
    compiled : bool
        True.
    digest : str
        Of the model and of all sources behind these functions.
    """

    compiled = True
    column = 3
    matrix = staticmethod(rearranged.matrix)

    def __init__(
        self, name: str, digest: str, linearise: Any, bordered: Any, inspect: Any, flip: Any, transpose: Any
    ) -> None:
        self.name, self.digest = name, digest
        self.linearise, self.bordered, self._inspect = linearise, bordered, inspect
        self.assign, self._flip, self.transpose = path.assign, flip, transpose
        self._outlined = outlined(self, digest)

    @property
    def inspect(self) -> Any:
        """Multipliers and margins."""
        if not self._inspect.overloads:
            wait_for(self.name, self._inspect)
        return self._inspect

    @property
    def flip(self) -> Any:
        """The Jacobian of the motion that comes back with another sign."""
        wait_for(self.name, self._flip)
        return self._flip

    def newton(
        self,
        data: Any,
        u: np.ndarray,
        p: float,
        work: Any,
        border: np.ndarray,
        step: np.ndarray,
        tangent: np.ndarray,
        tolerance: float,
        limit: int,
    ) -> tuple[float, int, float]:
        """Newton's method at fixed p (or on the hyperplane of `border`), halving steps that do not help.

        Parameters
        ----------
        data : CycleData
        u : ndarray, shape (N,)
            Unknowns, changed in place.
        p : float
        work : Workspace
        border, step, tangent : ndarray, shape (N + 1,)
            The last two are filled.
        tolerance : float
            Of the last correction.
        limit : int
            Of iterations.

        Returns
        -------
        residual : float
            Infinite where it does not converge.
        iterations : int
        p : float
        """
        kept = self._outlined.keep(data, work)
        assert kept is not None
        kernels = kept.kernels
        addresses = kernels.linearise, kernels.bordered, 0
        return _solvers()[0](addresses, kept.at, u, p, work.trial, border, step, tangent, tolerance, limit)

    def examine(self, data: Any, u: np.ndarray, p: float, work: Any, row: np.ndarray) -> float:
        """Residual, and the row of `inspect`, of one solution."""
        kept = self._outlined.keep(data, work)
        assert kept is not None
        with kept_back():  # few words need what calls Python
            return _solvers()[1](kept.kernels.all, kept.at, u, p, row)


@cache
def _assemble(kernels: Any, node: int, name: str) -> Kernels:
    files = [
        kernels.__file__,
        *getattr(kernels, "SOURCES", ()),
        compiling.__file__,
        arguments.__file__,
        two_unknowns.__file__,
        block_cyclic.__file__,
        closure.__file__,
        by_address.__file__,
        vectorised.__file__,
        path.__file__,
        trigonometry.__file__,
        factors.__file__,
        periodic_schur.__file__,
        product_of_any.__file__,
        product_of_two.__file__,
        periodic_qr.__file__,
        small_eigenvalues.__file__,
        rearranged.__file__,
        __file__,
    ]
    digest = hashlib.blake2b(b"".join(Path(file).read_bytes() for file in files), digest_size=6).hexdigest()
    stamp = f"{name}_{digest}"
    eliminate = block_cyclic.cyclic_kernels(node).bordered
    from_python(eliminate, specialise(_bordered, stamp, bordered=eliminate))  # loci do, point by point
    inspect = specialise(
        _inspect,
        stamp,
        inline=True,
        unpin=kernels.unpin,
        multipliers=periodic_schur.multipliers_of(node),
        margins=kernels.margins,
    )
    flip = specialise(rearranged.flip, stamp, inline=True, unpin=kernels.unpin)
    linearise = specialise(kernels.linearise.py_func, stamp, inline=True)  # normal forms call it from Python
    return Kernels(name, stamp, linearise, eliminate, inspect, flip, rearranged.transpose)


def assemble(model: Model) -> Kernels:
    """The compiled functions for `model`, made once per process."""
    return _assemble(model.kernels, model.node, model.name)
