"""Block-cyclic systems: maps between consecutive events, closed into a cycle, solved in O(l) by orthogonal elimination.

A periodic orbit with nodes x_0 .. x_{L-1} solves g_i(x_i, x_{i+1}, p) = 0 with x_L the closure of x_0. Its Jacobian has
two blocks per row, A_i = dg_i/dx_i and D_i = dg_i/dx_{i+1}, and one column Q_i = dg_i/dp. `bordered` eliminates the
inner nodes with Householder reflections (Wright's structured orthogonal factorisation, SIAM J. Sci. Stat. Comput. 13
(1992) 742), so that no product of matrices is formed and long, strongly unstable cycles lose nothing.

`cyclic_kernels` makes the compiled functions for a node size; they allocate nothing.
"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np

from contvines_ground.parts import part
from orbits.compiling.arguments import Workspace
from orbits.compiling.decorators import OPTIONS, kernel
from orbits.elimination import two_unknowns
from orbits.elimination.by_address import UNLINKED, call, links
from orbits.elimination.closure import TINY, closing
from orbits.elimination.vectorised import SHORTEST, room
from orbits.multipliers.periodic_schur import scratch_size

EMPTY = np.zeros(0)


def workspace(length: int, node: int, parameters: int) -> Workspace:
    """Arrays for one system of `length` nodes of `node` unknowns and `parameters` numbers."""
    n = node
    F, A, D, Q = (
        np.zeros((length, n)),
        np.zeros((length, n, n)),
        np.zeros((length, n, n)),
        np.zeros((length, n)),
    )
    solution, stored = np.zeros((2, length * n + 1)), np.zeros((length, n, 3 * n + 2))
    small, order = np.zeros((n, n + 2)), np.zeros(n + 1, np.int64)
    lanes, addresses = EMPTY, UNLINKED
    if n == 2 and length >= SHORTEST:
        lanes, parts = room(length)
        addresses = links((F, A, D, Q, *parts, solution, stored, small, order))
    return Workspace(
        F,
        A,
        D,
        Q,
        numbers=np.zeros(2 * parameters),
        trig=np.zeros((length + 1, 8)),
        stored=stored,
        panel=np.zeros((2 * n, 3 * n + 2)),
        small=small,
        solution=solution,
        pin=np.zeros(4 * n + 2),
        scratch=np.zeros(scratch_size(length, n)),
        re=np.zeros(n),
        im=np.zeros(n),
        order=order,
        trial=np.zeros(length * n),
        lanes=lanes,
        sines=np.zeros(length + 1),
        cosines=np.zeros(length + 1),
        links=addresses,
    )


@cache
def cyclic_kernels(node: int) -> SimpleNamespace:
    """Compiled elimination for cycles whose nodes have `node` unknowns.

    In one piece: the kernels share a size that numba unrolls, and so are made together.

    Returns
    -------
    SimpleNamespace
        ``bordered(data, work, border, target, step, tangent)``.
    """
    n = node
    close = closing(n)
    width = 3 * n + 2  # columns x_i | x_0 | x_{i+1} | p | right-hand side
    at_first, at_next, at_p, at_rhs = n, 2 * n, 3 * n, 3 * n + 1

    @part(forceinline=True, fastmath={"contract", "nsz", "arcp"}, **OPTIONS)
    def triangularise(panel):
        """Householder reflections that clear the first n columns of the 2n rows; returns the sign of the factor."""
        sign = 1.0
        for j in range(n):
            square = 0.0
            for i in range(j + 1, 2 * n):
                square += panel[i, j] * panel[i, j]
            head = panel[j, j]
            if square > 0.0:
                norm = np.sqrt(square + head * head)
                if head > 0.0:
                    norm = -norm
                v0 = head - norm
                factor = -1.0 / (norm * v0)
                for c in range(j + 1, width):
                    dot = v0 * panel[j, c]
                    for i in range(j + 1, 2 * n):
                        dot += panel[i, j] * panel[i, c]
                    dot *= -factor
                    panel[j, c] += dot * v0
                    for i in range(j + 1, 2 * n):
                        panel[i, c] += dot * panel[i, j]
                panel[j, j] = norm
                sign = -sign
            if panel[j, j] < 0.0:
                sign = -sign
        return sign

    @kernel
    def forward(F, A, D, Q, stored, panel):
        """Eliminate the inner nodes one after the other; panel[:n] keeps V x_L + U x_0 + w p = r; returns a sign."""
        length = F.shape[0]
        sign = 1.0
        # the condensed equation  panel[:n]:  V x_i + U x_0 + w p = r
        for i in range(n):
            for c in range(n):
                panel[i, c] = D[0, i, c]
                panel[i, at_first + c] = A[0, i, c]
            panel[i, at_p] = Q[0, i]
            panel[i, at_rhs] = -F[0, i]
        for block in range(1, length):
            for i in range(n):
                for c in range(n):
                    panel[n + i, c] = A[block, i, c]
                    panel[n + i, at_first + c] = 0.0
                    panel[n + i, at_next + c] = D[block, i, c]
                    panel[i, at_next + c] = 0.0
                panel[n + i, at_p] = Q[block, i]
                panel[n + i, at_rhs] = -F[block, i]
            sign *= triangularise(panel)
            for i in range(n):
                for c in range(width):
                    stored[block, i, c] = panel[i, c]
                for c in range(n):
                    panel[i, c] = panel[n + i, at_next + c]
                    panel[i, at_first + c] = panel[n + i, at_first + c]
                panel[i, at_p] = panel[n + i, at_p]
                panel[i, at_rhs] = panel[n + i, at_rhs]
        return sign

    @kernel
    def eliminate(F, A, D, Q, twist, stored, panel, small, order, solution):
        """Particular and null solution of J x + F_p p = -F, one node after the other; returns a sign."""
        length = F.shape[0]
        size = length * n
        sign = forward(F, A, D, Q, stored, panel)
        for i in range(n):
            for c in range(n):
                small[i, c] = panel[i, at_first + c] + (panel[i, c] if c == 0 else twist * panel[i, c])
            small[i, n] = panel[i, at_p]
            small[i, n + 1] = panel[i, at_rhs]
        sign *= close(small, solution, order)
        for block in range(length - 1, 0, -1):
            for i in range(n - 1, -1, -1):
                pivot = stored[block, i, i]
                if abs(pivot) < TINY:
                    pivot = TINY
                particular = stored[block, i, at_rhs] - stored[block, i, at_p] * solution[0, size]
                null = -stored[block, i, at_p] * solution[1, size]
                for c in range(n):
                    coefficient = stored[block, i, at_first + c]
                    particular -= coefficient * solution[0, c]
                    null -= coefficient * solution[1, c]
                    coefficient = stored[block, i, at_next + c]
                    if block + 1 < length:
                        particular -= coefficient * solution[0, (block + 1) * n + c]
                        null -= coefficient * solution[1, (block + 1) * n + c]
                    else:
                        if c > 0:
                            coefficient *= twist
                        particular -= coefficient * solution[0, c]
                        null -= coefficient * solution[1, c]
                for c in range(i + 1, n):
                    particular -= stored[block, i, c] * solution[0, block * n + c]
                    null -= stored[block, i, c] * solution[1, block * n + c]
                solution[0, block * n + i] = particular / pivot
                solution[1, block * n + i] = null / pivot
        return sign

    @kernel
    def eliminate_by_two(F, A, D, Q, twist, stored, small, order, solution, listed):
        """The same for two unknowns per node, two halves side by side; eight segments where the cycle is long enough."""
        length = F.shape[0]
        if length < SHORTEST:
            return two_unknowns.eliminate(F, A, D, Q, twist, stored, small, order, solution)
        return call(listed[0], length, twist, listed.ctypes.data)

    @part(forceinline=True, **OPTIONS)
    def products(border, solution):
        """Products of a row with the null and with the particular solution."""
        along, across = 0.0, 0.0
        for i in range(border.shape[0]):
            across += border[i] * solution[0, i]
            along += border[i] * solution[1, i]
        return along, across

    @kernel
    def bordered(data, work, border, target, step, tangent):
        """Solve [[J, F_p], [border]] z = (-F, target) into `step` and = (0, 1) into `tangent`.

        Parameters
        ----------
        data : CycleData
        work : Workspace
            Of the problem; the last linearisation is read from `work`.
        border, step, tangent : float array (L n + 1,)
        target : float

        Returns
        -------
        float
            Sign of the determinant (up to a constant of the word), 0 if the matrix is singular.
        """
        F, A, D, Q, solution = work.F, work.A, work.D, work.Q, work.solution
        size = solution.shape[1] - 1
        if n == 2:
            sign = eliminate_by_two(
                F, A, D, Q, data.twist, work.stored, work.small, work.order, solution, work.links
            )
        else:
            sign = eliminate(
                F, A, D, Q, data.twist, work.stored, work.panel, work.small, work.order, solution
            )
        along, across = products(border, solution)
        if along == 0.0:
            along = TINY
            sign = 0.0
        elif along < 0.0:
            sign = -sign
        by = 1.0 / along
        share = (target - across) * by
        for i in range(size + 1):
            step[i] = solution[0, i] + share * solution[1, i]
            tangent[i] = solution[1, i] * by
        return sign

    return SimpleNamespace(bordered=bordered)
