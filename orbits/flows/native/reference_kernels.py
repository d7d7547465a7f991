"""Kernels for the built-in machines' cycles in plain Python and numpy: the reference with which the native core is compared."""

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
    """Kernels for the cycles of one model, in plain Python and numpy.

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
        """Write residual and derivatives into `work`; return the largest residual, infinity if it cannot be evaluated."""
        with np.errstate(all="ignore"):
            try:
                return float(self.machine.linearise(data, u, p, work))
            except (ArithmeticError, ValueError):  # functions in `math` raise errors in place of infinity
                return math.inf

    def fill(self, data: CycleData, work: Workspace, matrix: np.ndarray) -> None:
        """Write the whole Jacobian into `matrix`."""
        matrix[:] = jacobian(data, work)

    def flip(self, data: CycleData, work: Workspace, sign: float) -> None:
        """Turn the closure x_L = T x_0 of the linearisation into x_L = -T x_0 (sign = -1), and back (sign = 1).

        T is the closure's own twist. The pin of an impact-free motion is removed first: with the opposite sign the closure needs none.
        """
        maps.unpin(data, work)
        np.negative(work.D[-1], out=work.D[-1])

    def transpose(self, data: CycleData, work: Workspace, column: np.ndarray, other: Workspace) -> None:
        """Write the transposed system into another workspace, with `column` (L n,) as its last column.

        Row k of J contains A_k at node k and D_k at node k + 1. Therefore column k + 1 of J, a row of the transposed matrix, contains D_k^T and
        A_{k+1}^T: the new system is block-cyclic with blocks D_k^T and A_{k+1}^T. The closure's twist, which scales columns of D_{L-1}, scales
        rows here; in the last block it is divided out (it is its own inverse), because the elimination applies it to the last D.
        """
        other.A[:] = work.D.transpose(0, 2, 1)
        other.A[-1, 1:] *= data.twist
        other.D[:] = np.roll(work.A, -1, axis=0).transpose(0, 2, 1)
        other.D[-1, :, 1:] *= data.twist
        other.Q[:] = np.roll(column.reshape(other.Q.shape), -1, axis=0)

    def inspect(self, data: CycleData, u: np.ndarray, p: float, work: Workspace, row: np.ndarray) -> None:
        """Write multipliers of the closure map as pairs (re, im), then four margins per node, into `row`."""
        maps.unpin(data, work)
        A, D = work.A, work.D
        length, n = A.shape[0], A.shape[1]
        # The later motion does not depend on the instants at which a stick begins and ends: w' = 0 there and v'' is continuous, at
        # a slip also w'' = 0. The derivatives of these phases contain 1/w'' and the reciprocal rate of the friction's reserve, which
        # become infinite as the stick vanishes. So the phases are kept fixed here.
        for i in range(length):
            if data.events[(i + 1) % length] in (STICK, SLIP):
                A[i, 0, :], D[i, 0, :] = 0.0, 0.0
                D[i, 0, 0] = 1.0
        re, im = np.empty(n), np.empty(n)
        multipliers(A, D, data.twist, re, im)
        if (
            data.pinned
        ):  # shifting an impact-free motion gives a trivial multiplier, nearest to the twist: drop it
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
