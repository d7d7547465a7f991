"""The bordered system of a Jacobian that is a LinearOperator, by GMRES."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

KRYLOV = 1e-11  # relative residual of GMRES


def iterate(data: Any, work: Any, border: np.ndarray, sides: np.ndarray) -> tuple[np.ndarray, float]:
    """Solutions of the bordered system; the sign of the determinant is not known.

    NaN where GMRES does not converge. `work` has F_u and F_p.
    """
    n = len(border)
    inverse = data.preconditioner_at()

    def applied(x: np.ndarray) -> np.ndarray:
        x = x.reshape(-1)
        return np.append(work.jacobian @ x[:-1] + work.derivative * x[-1], border @ x)

    def precondition(x: np.ndarray) -> np.ndarray:
        x = x.reshape(-1)
        return np.append(inverse @ x[:-1], x[-1] / max(float(np.abs(border).max()), 1e-300))

    operator = LinearOperator((n, n), matvec=applied, dtype=float)  # type: ignore[call-arg]
    near = None if inverse is None else LinearOperator((n, n), matvec=precondition, dtype=float)  # type: ignore[call-arg]
    result = np.zeros_like(sides)
    for k in range(2):
        if np.any(sides[:, k]):
            found, _ = gmres(
                operator, sides[:, k], M=near, rtol=KRYLOV, atol=0.0, restart=min(n, 80), maxiter=40
            )
            gap = np.linalg.norm(applied(found) - sides[:, k]) / np.linalg.norm(sides[:, k])
            result[:, k] = found if gap < 1e-4 else np.nan
    return result, 1.0
