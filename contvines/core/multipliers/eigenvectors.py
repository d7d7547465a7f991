"""Eigenvectors of a cycle for a given multiplier, from the factors and never from their product."""

import numpy as np


def eigenvector(A, D, twist, multiplier):
    """Eigenvector of a cycle for one of its multipliers, at every node.

    With y_i = x_i / |multiplier|^{i/L} the eigenvalue problem is the homogeneous block-cyclic system
    A_i y_i + |multiplier|^{1/L} D_i y_{i+1} = 0, y_L = (multiplier / |multiplier|) S y_0. Its inner nodes are
    eliminated by orthogonal transformations (Wright, SIAM J. Sci. Stat. Comput. 13 (1992) 742) and y_0 is the
    right singular vector of what is left.

    Parameters
    ----------
    A, D : ndarray (L, n, n)
        Derivatives of the i-th map with respect to its first and its second node.
    twist : float
        Closure S = diag(1, twist, twist, ...).
    multiplier : float or complex
        An eigenvalue of S M_{L-1} .. M_0, M_i = -D_i^{-1} A_i; not zero.

    Returns
    -------
    vectors : ndarray (L, n)
        y_i: the eigenvector carried round the cycle, growth spread evenly over the nodes (so that nothing
        overflows). ``vectors[0]`` has unit length and its largest component is real and positive. Real for a
        real multiplier.
    gap : float
        Smallest over second smallest singular value of the reduced matrix: small when the multiplier is
        accurate and simple.

    Raises
    ------
    ValueError
        If the multiplier is zero or not finite.
    """
    A, D = np.asarray(A, float), np.asarray(D, float)
    length, n = A.shape[:2]
    size = abs(multiplier)
    if not 0.0 < size < np.inf:
        raise ValueError(f"multiplier is {multiplier}; an eigenvector needs one that is finite and not zero")
    growth = size ** (1.0 / length)
    phase = multiplier / size
    if np.imag(phase) == 0.0:
        phase = float(np.real(phase))
    closure = np.diag(np.r_[1.0, np.full(n - 1, twist)])

    first, ahead = A[0], growth * D[0]  # first . y_0 + ahead . y_{i+1} = 0 once the nodes between are gone
    kept = []
    zero = np.zeros((n, n))
    for i in range(1, length):
        q, r = np.linalg.qr(np.vstack([ahead, A[i]]), mode="complete")
        panel = q.T @ np.block([[first, zero], [zero, growth * D[i]]])
        kept.append((r[:n], panel[:n]))
        first, ahead = panel[n:, :n], panel[n:, n:]
    _, values, right = np.linalg.svd(first + phase * ahead @ closure)
    start = right[-1].conj()
    lead = start[np.argmax(np.abs(start))]
    start = start * (abs(lead) / lead)
    vectors = np.empty((length, n), start.dtype)
    vectors[0] = start
    following = phase * closure @ start
    for i in range(length - 1, 0, -1):
        r, panel = kept[i - 1]
        following = np.linalg.lstsq(r, -panel @ np.concatenate([start, following]), rcond=None)[0]
        vectors[i] = following
    return vectors, float(values[-1] / values[-2]) if n > 1 else 0.0
