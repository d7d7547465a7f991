"""The damper between the moving base and the oscillator."""

from __future__ import annotations

import numpy as np


def share_of_the_base(params: np.ndarray, periods: int, overlap: float) -> float:
    """What the base's motion adds to the loss in the damper: lambda times the integral of (q1' - e')^2 - q1'^2.

    By parts the integral of q1' e' is Omega^2 times that of q1 e; `overlap` is the integral of q1 sin Psi over the phase.
    """
    forcing, omega, damping, eps = (float(value) for value in params[:4])
    exact, base = float(params[7]), eps * forcing
    own = np.pi * periods * omega * base**2
    return exact * damping * (own - 2.0 * omega * base * overlap)
