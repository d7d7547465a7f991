"""Names of the measures of orbits, and what kind of quantity each is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contvines.shared.modulation import BAND
from orbits.machines.base import Model

LOADS = (
    "impact_rate",
    "impulse",
    "impulse_left",
    "impulse_right",
    "impact_energy",
    "mean_force",
    "work_rate",
    "peak_force",
)
WITHOUT_IMPACTS = (*LOADS, "impact_loss", "impact_speed", "impact_speed_min")
"""Measures that are 0 without impacts; others of impacts are not a number there."""
COMMON = (
    *("B", "B_post", "B_pre", "B_mean", "C2", "phase", "impact_speed", "impact_speed_min"),
    *("impact_loss", "friction_loss", "max_abs_w"),
    *LOADS,
)

ANGLES = ("phase", "v_phase")  # radians, modulo 2 pi
ENERGIES = (  # per period of the orbit
    "impact_loss",
    "friction_loss",
    "input_work",
    "damping_loss",
    "force_work",
    "grounded_damping_loss",
)
MEANS = {f"{name}_mean": name for name in ENERGIES}  # per forcing period

KINDS = {
    **dict.fromkeys(("B", "B_post", "B_pre", "B_mean", "impact_speed", "impact_speed_min"), "velocity"),
    "C2": "area",
    **dict.fromkeys(("phase", "v_phase"), "angle"),
    **dict.fromkeys(("max_abs_w", "max_abs_q1", *BAND, "amplitude"), "length"),
    "impact_rate": "rate",
    **dict.fromkeys(("impulse", "impulse_left", "impulse_right"), "impulse"),
    "impact_energy": "energy",
    **dict.fromkeys(("mean_force", "peak_force"), "force"),
    "work_rate": "power",
    **dict.fromkeys((*ENERGIES, *MEANS), "energy"),
}
"""What kind of quantity each measure is, where it is more than a number."""


def loads(
    speeds: np.ndarray,
    restitution: np.ndarray,
    mass: np.ndarray,
    at: Sequence[str],
    walls: Sequence[str],
    duration: np.ndarray,
    held: np.ndarray | float | None,
) -> dict[str, np.ndarray]:
    """Measures of the forces at walls by name, (m,), and `impact_loss`, the energy that impacts take.

    Parameters
    ----------
    speeds, restitution, mass : float array (m, l)
        Of each impact of m solutions: the speed before it, the wall's restitution, the mass of the relative motion.
    at, walls : sequence of str
        The wall that each hits, and all walls, as the names of their impulses end.
    duration : float array (m,)
    held : float array (m,) or float, optional
        Duration of an impact, whose force is half a sine: impulse = 2 F T/pi.
    """
    impulses, energies = (1.0 + restitution) * mass * speeds, 0.5 * mass * speeds**2
    largest = {wall: impulses[:, [one == wall for one in at]].max(axis=1, initial=0.0) for wall in walls}
    found = {
        "impact_rate": speeds.shape[1] / duration,
        "impulse": impulses.max(axis=1, initial=0.0),
        "impact_energy": energies.max(axis=1, initial=0.0),
        "impact_loss": ((1.0 - restitution**2) * energies).sum(axis=1),
        "mean_force": impulses.sum(axis=1) / duration,
        **{f"impulse_{wall}": values for wall, values in largest.items()},
    }
    if held is not None:
        found["peak_force"] = found["impulse"] * np.pi / (2.0 * held)
    return found


def way_out(name: str) -> str:
    """What gives a machine a measure that it has not, as a sentence ends with it; empty where nothing does."""
    return (
        " (a peak force needs contact_time, the duration of an impact: in [model], of a declared machine among its parameters)"
        if name == "peak_force"
        else ""
    )


def names(model: Model) -> tuple[str, ...]:
    """Measures that orbits of this machine have; a peak force only where the contact time is known."""
    known = COMMON + model.own_measures
    if model.contact_time is None:
        known = tuple(name for name in known if name != "peak_force")
    return known + tuple(mean for mean, name in MEANS.items() if name in known)
