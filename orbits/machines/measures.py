"""Names of the measures of orbits, and what kind of quantity each is."""

from __future__ import annotations

from contvines.shared.modulation import BAND
from orbits.machines.base import Model

COMMON = (
    "B",
    "B_post",
    "B_pre",
    "B_mean",
    "C2",
    "phase",
    "impact_speed",
    "impact_speed_min",
    "impact_loss",
    "friction_loss",
    "max_abs_w",
    "impact_rate",
    "impulse",
    "impulse_left",
    "impulse_right",
    "impact_energy",
    "mean_force",
    "work_rate",
    "peak_force",
)
LOADS = (
    "impact_rate",
    "impulse",
    "impulse_left",
    "impulse_right",
    "impact_energy",
    "mean_force",
    "peak_force",
)  # nothing without impacts

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
    "B": "velocity",
    "B_post": "velocity",
    "B_pre": "velocity",
    "B_mean": "velocity",
    "C2": "area",
    "phase": "angle",
    "impact_speed": "velocity",
    "impact_speed_min": "velocity",
    "max_abs_w": "length",
    **dict.fromkeys(("max_abs_q1", *BAND), "length"),
    "amplitude": "length",
    "v_phase": "angle",
    "impact_rate": "rate",
    **dict.fromkeys(("impulse", "impulse_left", "impulse_right"), "impulse"),
    "impact_energy": "energy",
    **dict.fromkeys(("mean_force", "peak_force"), "force"),
    "work_rate": "power",
    **dict.fromkeys((*ENERGIES, *MEANS), "energy"),
}
"""What kind of quantity each measure is, where it is more than a number."""


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
