"""The kernels of the built-in machines' cycles in plain Python and numpy: what the native core is compared with."""

from __future__ import annotations

import math

import numpy as np

from contvines.core.multipliers.periodic_schur import reference as multipliers
from orbits.arguments import CycleData, Workspace, jacobian
from orbits.flows.plain_kernels import PlainKernels
from orbits.machines import parameters
from orbits.machines.reference import maps
from orbits.machines.reference.machine import Reference
from orbits.words.alphabet import CODES

STICK, SLIP = CODES["s"], CODES["u"]


class ReferenceKernels(PlainKernels[CycleData, Workspace]):
    """Cycles of one model, in plain Python and numpy: what the native core is compared with.

    Parameters
    ----------
    machine : Reference
        `linearise` and `margins` of the model.
    """

    natural = True
    column = 3
    matrix = staticmethod(jacobian)
    assign = staticmethod(parameters.assign)

    def __init__(self, machine: Reference) -> None:
        self.machine = machine

    def linearise(self, data: CycleData, u: np.ndarray, p: float, work: Workspace) -> float:
        """Residual and derivatives into `work`; returns the largest residual, infinity where it cannot be evaluated."""
        with np.errstate(all="ignore"):
            try:
                return float(self.machine.linearise(data, u, p, work))
            except (ArithmeticError, ValueError):  # of functions in `math`, which have no infinity
                return math.inf

    def fill(self, data: CycleData, work: Workspace, matrix: np.ndarray) -> None:
        """The whole Jacobian."""
        matrix[:] = jacobian(data, work)

    def flip(self, data: CycleData, work: Workspace, sign: float) -> None:
        """Turn the closure x_L = T x_0 of the linearisation into x_L = -T x_0 (sign = -1), and back (sign = 1).

        T is the closure's own twist. The shift of an impact-free motion is put back before: turned round, the closure needs no pin.
        """
        maps.unpin(data, work)
        np.negative(work.D[-1], out=work.D[-1])

    def transpose(self, data: CycleData, work: Workspace, column: np.ndarray, other: Workspace) -> None:
        """Write the transposed system into another workspace, with `column` (L n,) as its last column.

        Row k of J ties nodes k and k + 1 by A_k and D_k. Column k + 1 therefore ties the left unknowns of rows k and k + 1 by
        D_k^T and A_{k+1}^T: block k of the new system, which is block-cyclic again. The closure's twist, which scales columns of D_{L-1},
        scales rows here; in the last block it is taken out of the place where the elimination puts it.
        """
        other.A[:] = work.D.transpose(0, 2, 1)
        other.A[-1, 1:] *= data.twist
        other.D[:] = np.roll(work.A, -1, axis=0).transpose(0, 2, 1)
        other.D[-1, :, 1:] *= data.twist
        other.Q[:] = np.roll(column.reshape(other.Q.shape), -1, axis=0)

    def inspect(self, data: CycleData, u: np.ndarray, p: float, work: Workspace, row: np.ndarray) -> None:
        """Multipliers of the closure map as (re, im) pairs, then four margins per node, into `row`."""
        maps.unpin(data, work)
        A, D = work.A, work.D
        length, n = A.shape[0], A.shape[1]
        # Nothing later depends on when a stick begins or ends: w' = 0 there and v'' is the same before and after, at a slip
        # w'' = 0, too. Those phases move with 1/w'' and one over the rate at which friction gives way, which grow without
        # bound where the stick vanishes, so they are held instead.
        for i in range(length):
            if data.events[(i + 1) % length] in (STICK, SLIP):
                A[i, 0, :], D[i, 0, :] = 0.0, 0.0
                D[i, 0, 0] = 1.0
        re, im = np.empty(n), np.empty(n)
        multipliers(A, D, data.twist, re, im)
        if (
            data.pinned
        ):  # an impact-free motion may be moved as a whole: drop that multiplier, nearest to the twist
            away = np.hypot(re - data.twist, im)
            trivial = int(np.argmin(away)) if np.isfinite(away).all() else 0
            re, im = np.delete(re, trivial), np.delete(im, trivial)
        count = len(re)
        row[0 : 2 * count : 2], row[1 : 2 * count : 2] = re, im
        with np.errstate(all="ignore"):
            try:
                self.machine.margins(data, u, work, row[2 * count :])
            except (ArithmeticError, ValueError):
                row[2 * count :] = math.nan
