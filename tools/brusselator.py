"""Brusselator on a line: u_t = D u_xx + A - (b + 1) u + u^2 v and v_t = E v_xx + b u - u^2 v, without flux at the ends."""

import numpy as np
import scipy.sparse as sp


def brusselator(m, A, D, E):
    """Return functions of (w, b) for m cells: equations, sparse Jacobian and derivative by b; the unknowns w are u_0, v_0, u_1, v_1 ..."""
    line = sp.diags_array([np.ones(m - 1), -2.0 * np.ones(m), np.ones(m - 1)], offsets=[-1, 0, 1]).tolil()
    line[0, 0] = line[m - 1, m - 1] = -1.0
    order = np.arange(2 * m).reshape(2, m).T.reshape(-1)
    diffusion = sp.block_diag([D * m**2 * line, E * m**2 * line]).tocsc()[order][:, order].tocsc()

    def F(w, b):
        u, v = w[0::2], w[1::2]
        out = diffusion @ w
        out[0::2] += A - (b + 1.0) * u + u * u * v
        out[1::2] += b * u - u * u * v
        return out

    def jacobian(w, b):
        u, v = w[0::2], w[1::2]
        here, above, below = np.empty(2 * m), np.zeros(2 * m - 1), np.zeros(2 * m - 1)
        here[0::2], here[1::2] = -(b + 1.0) + 2.0 * u * v, -u * u
        above[0::2], below[0::2] = u * u, b - 2.0 * u * v
        return (diffusion + sp.diags_array([below, here, above], offsets=[-1, 0, 1])).tocsc()

    def derivative(w, b):
        out = np.empty(2 * m)
        out[0::2], out[1::2] = -w[0::2], w[0::2]
        return out

    return F, jacobian, derivative
