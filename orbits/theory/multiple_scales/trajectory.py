"""Integrate the slow flow along one manifold until the time is over or the manifold ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from orbits.settings import THEORY

from .. import manifolds
from .flow import Manifold, SlowFlow

ENDS = {
    "time": "the asked span of slow time is over",
    "activation": "the amplitude fell to the activation threshold and the flow left the impacting manifold",
    "symmetry-breaking": "the amplitude reached C_max, beyond which the symmetric orbit no longer attracts",
    "wall": "the sliding absorber reached the walls",
    "stick": "the sliding absorber began to stick at its turns",
}


@dataclass(frozen=True)
class SlowTrajectory:
    """Slow motion along a manifold: arrays over `slow_time` ``eps tau``, and why it ended (a key of `ENDS` and its sentence)."""

    manifold: Manifold
    slow_time: NDArray
    velocity: NDArray
    amplitude: NDArray
    phase: NDArray
    ended: str
    why: str


def integrate(
    flow: SlowFlow,
    detuning: float,
    amplitude: float,
    phase: float,
    span: float,
    manifold: Manifold = "impacting",
    *,
    stop_at_symmetry_limit: bool = False,
    points: int = 400,
) -> SlowTrajectory:
    """Follow the slow flow from an amplitude ``C`` and phase ``gamma``.

    Parameters
    ----------
    flow : SlowFlow
    detuning : float
    amplitude, phase : float
        Start on the manifold (on its right part, if impacting).
    span : float
        Slow time ``eps tau`` to integrate.
    manifold : {"impacting", "sliding"}
    stop_at_symmetry_limit : bool
        End an impacting trajectory at ``C_max`` too.
    points : int
        Points returned, evenly spaced.

    Returns
    -------
    SlowTrajectory

    Raises
    ------
    ValueError
        If the manifold has no point at this amplitude.
    """
    R, h = float(flow.loss), float(flow.level)
    low, high = (float(x) for x in flow.sliding_bounds)
    if manifold == "sliding":
        if not low < amplitude < high:
            raise ValueError(
                f"amplitude = {amplitude!r} must lie in ({low:.6g}, {high:.6g}), "
                "where the absorber purely slides."
            )
        start = float(manifolds.turning_point(amplitude, h))
    else:
        start = float(manifolds.velocity_at(amplitude, R, h))
        if not start > float(flow.activation.velocity):
            raise ValueError(
                f"amplitude = {amplitude!r} must exceed C_min = {float(flow.activation.amplitude):.6g}."
            )

    def rate(_time: float, state: NDArray) -> list[float]:
        growth, turn = flow.rates(state[0], state[1], detuning, manifold)
        return [float(growth / flow.harmonic_slopes(state[0], manifold)[0]), float(turn)]

    if manifold == "sliding":
        limits = {"stick": 2.0 * h / np.pi, "wall": 1.0}
    else:
        # the lowest point is singular (C^2 does not determine B there), so stop slightly before it
        limits = {"activation": float(flow.activation.velocity) + THEORY.off_end}
        if stop_at_symmetry_limit:
            limits["symmetry-breaking"] = float(flow.symmetry_limit.velocity)

    def gate(value: float):
        def crossing(_time: float, state: NDArray) -> float:
            return float(state[0] - value)

        crossing.terminal = True  # type: ignore[attr-defined]
        return crossing

    names = list(limits)
    run = solve_ivp(
        rate, (0.0, span), [start, phase], method="DOP853", rtol=THEORY.relative, atol=THEORY.absolute,
        events=[gate(limits[name]) for name in names], dense_output=True,
    )  # fmt: skip
    ended = "time"
    for name, times in zip(names, run.t_events or []):
        if len(times):
            ended = name
    time = np.linspace(0.0, run.t[-1], points)
    position, gamma = run.sol(time)
    reached = np.sqrt(flow.harmonics(position, manifold)[0])
    velocity = position if manifold == "impacting" else np.zeros_like(position)
    return SlowTrajectory(manifold, time, velocity, reached, gamma, ended, ENDS[ended])
