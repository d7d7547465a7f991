"""Data and workspaces of the kernels of cycles, each one struct of the native core, and constants of floating-point arithmetic.

The native core (native/cycles.hpp) and the reference use the same memory.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contvines.core.table import block

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

Reals = float | np.ndarray
"""A number, or an array of numbers, with the shape of the arguments."""
ROUNDOFF = 2.3e-16
"""Slightly more than the relative distance of neighbouring floats: a smaller share of a number does not change it."""
SMALLEST = 1e-300
"""Smallest divisor, so that no quotient of ordinary numbers is undefined."""
UNBOUNDED = 1e15
"""Value for a multiplier that tends to infinity at a border; larger than any multiplier that double precision resolves."""
COMPLEX_STEP = 1e-200
"""Its square is zero, so that real parts of complex steps are those of real arithmetic; it changes no bit of an ordinary number."""


class CycleData(NamedTuple):
    """The equations of cycles with one word against one parameter, constant while a branch is traced; see `cycle_data`."""

    events: np.ndarray
    """Codes of the letters (`orbits.words.alphabet.CODES`), shape (L,)."""
    modes: np.ndarray
    """Direction of sliding after each event, 0 while the absorber sticks, shape (L,)."""
    params: np.ndarray
    """The machine's numbers, shape (P,)."""
    path: np.ndarray
    """How the numbers depend on the varying parameter, shape (2, P); see `orbits.machines.parameters`."""
    twist: float
    """-1 if the second half of the cycle mirrors the first, else 1."""
    shift: float
    """Forcing phase from the first event to its return, in radians."""
    pinned: int
    """1 for a motion without impacts, which can be shifted as a whole; 2 for half of a symmetric one; 0 for motions with impacts."""
    active: int
    """Index of the varying parameter in the amounts."""
    amounts: np.ndarray
    """Values of all parameters that can vary, shape (Q,); `params` itself without a law."""
    law: np.ndarray
    """The numbers as products of powers of the amounts, shape (Q + 1, P); no rows if they are the numbers themselves."""
    memory: np.ndarray
    """All data as one struct."""

    def __reduce__(self) -> tuple[Callable, tuple]:
        return cycle_data, tuple(self)[:-1]  # the struct contains addresses


def cycle_data(
    events: Sequence[int] | np.ndarray,
    modes: Sequence[int] | np.ndarray,
    params: np.ndarray,
    path: np.ndarray,
    twist: float,
    shift: float,
    pinned: int,
    active: int,
    amounts: np.ndarray,
    law: np.ndarray,
) -> CycleData:
    """Return the data from its parts, which are copied; see `CycleData`."""
    length, count, powers = len(events), len(params), len(law)
    free = len(amounts) if powers else 0
    head = (length, count, len(amounts), powers, int(pinned), int(active), float(twist), float(shift))
    shapes = ((length,), (length,), (count,), (2, count), (free,), (powers, count))
    memory, (one, two, own, own_path, own_amounts, own_law) = block(head, shapes)
    codes, directions = one.view(np.int64), two.view(np.int64)
    codes[:], directions[:], own[:], own_path[:] = events, modes, params, path
    if powers:
        own_amounts[:], own_law[:] = amounts, law
    else:
        pointers = memory.view(np.int64)
        pointers[12] = pointers[10]  # without a law the amounts are the numbers themselves
        own_amounts = own
    return CycleData(
        codes,
        directions,
        own,
        own_path,
        float(twist),
        float(shift),
        int(pinned),
        int(active),
        own_amounts,
        own_law,
        memory,
    )


class Workspace(NamedTuple):
    """Arrays for one system of L nodes with n unknowns, allocated once and used by every kernel; see `workspace`."""

    F: np.ndarray
    """Residuals, shape (L, n)."""
    A: np.ndarray
    """Derivatives of the residuals by the node before each flight, shape (L, n, n)."""
    D: np.ndarray
    """Derivatives of the residuals by the node after it, shape (L, n, n)."""
    Q: np.ndarray
    """Derivatives of the residuals by the varying parameter, shape (L, n)."""
    numbers: np.ndarray
    """The machine's numbers and their derivatives by that parameter, shape (2 P,)."""
    pin: np.ndarray
    """The row that replaces an equation of a pinned motion, shape (4 n + 2,)."""
    sines: np.ndarray
    """Sines of the phases of the nodes, including the return of the first one, shape (L + 1,)."""
    cosines: np.ndarray
    memory: np.ndarray
    """All arrays, and further memory of the native core, as one struct."""

    def __reduce__(self) -> tuple[Callable, tuple]:
        return workspace, (self.F.shape[0], self.F.shape[1], len(self.numbers) // 2)


LANES, SHORTEST = (
    8,
    32,
)  # long cycles (SHORTEST nodes or more) with two unknowns per node are eliminated in LANES segments (native/elimination.hpp)


def workspace(length: int, node: int, parameters: int) -> Workspace:
    """Return arrays for one system of `length` nodes of `node` unknowns and `parameters` numbers."""
    size, square = length * node, length * node * node
    lanes = 0
    if node == 2 and length >= SHORTEST:
        nodes = LANES + length % LANES
        lanes = 120 * (length // LANES) + 16 * nodes + 16
    shapes = (
        (length, node),  # F, A, D, Q
        (length, node, node),
        (length, node, node),
        (length, node),
        (2 * parameters,),  # numbers
        (4 * node + 2,),  # pin
        (length + 1,),  # sines, cosines
        (length + 1,),
        (size * (3 * node + 2),),  # stored
        (2 * node * (3 * node + 2),),  # panel
        (node * (node + 2),),  # small
        (2 * (size + 1),),  # solution
        (lanes,),
        (3 * square + 4 * length + 8 * node * (node + 1),),  # scratch of multipliers
        (node,),  # re, im
        (node,),
    )
    memory, arrays = block((length, node), shapes)
    return Workspace._make([*arrays[:8], memory])


def jacobian(data: CycleData, work: Workspace) -> np.ndarray:
    """Return the derivatives of all residuals by all unknowns, shape (L n, L n), of the linearisation in a workspace."""
    A, D, twist = work.A, work.D, data.twist
    length, n = A.shape[0], A.shape[1]
    whole = np.zeros((length, n, length, n))
    np.einsum("kikj->kij", whole)[...] = A  # views: blocks on the diagonal, and beside it
    np.einsum("kikj->kij", whole[:-1, :, 1:])[...] = D[:-1]
    whole[-1, :, 0, 0] += D[-1, :, 0]
    whole[-1, :, 0, 1:] += twist * D[-1, :, 1:]
    return whole.reshape(length * n, length * n)
