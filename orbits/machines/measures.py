"""Measures of orbits: their names, kinds of quantity and labels on axes; and labels of parameters.

Labels of machines with units are in words, others in the field's notation.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from contvines.shared.motions import BAND


class Measure(NamedTuple):
    """Description of a measure.

    Attributes
    ----------
    kind : str
        Kind of quantity.
    label : str
        Label of an axis; empty: the name.
    words : str
        Label for machines with units, if it differs.
    """

    kind: str
    label: str = ""
    words: str = ""


LOADS = {
    "impact_rate": Measure("rate", "impacts per unit of time", "impacts per second"),
    "impulse": Measure("impulse", "largest impulse"),
    "impulse_left": Measure("impulse", "largest impulse at the left wall"),
    "impulse_right": Measure("impulse", "largest impulse at the right wall"),
    "impact_energy": Measure("energy", "energy of the hardest impact"),
    "mean_force": Measure("force", "mean force at the walls"),
    "work_rate": Measure("power", "power taken by impacts and friction"),
    "peak_force": Measure("force", "peak force of the hardest impact"),
}
_LOSSES = {"impact_loss": "loss at impacts", "friction_loss": "loss by friction"}
_WORKS = {
    "input_work": "work of the base",
    "damping_loss": "loss in the damper",
    "force_work": "work of the equivalent force",
    "grounded_damping_loss": "loss in a grounded damper",
}


def _energies(descriptions: dict[str, str]) -> dict[str, Measure]:
    return {
        name: Measure("energy", f"{description} per period of the orbit")
        for name, description in descriptions.items()
    }


COMMON = {
    "B": Measure("velocity", "velocity at the first impact $B$"),
    "B_post": Measure("velocity", "velocity after impact $B^+$"),
    "B_pre": Measure("velocity", "velocity before impact $B^-$"),
    "B_mean": Measure("velocity", "mean velocity at impacts $B$"),
    "C2": Measure("area", "$C^2$"),
    "phase": Measure("angle", "forcing phase at the first event"),
    "impact_speed": Measure("velocity", "fastest impact $|w'_-|$", "fastest impact"),
    "impact_speed_min": Measure("velocity"),
    **_energies(_LOSSES),
    "max_abs_w": Measure("length", r"largest $|w|$", "largest relative displacement"),
    **LOADS,
}
"""Measures of all built-in machines."""
DRIVEN = {
    "max_abs_q1": Measure(
        "length", r"largest $|q_1|$ in units of $b$", "largest displacement of the oscillator"
    ),
    "amplitude": Measure("length", "amplitude $C$", "amplitude"),
    "v_phase": Measure("angle"),
    **_energies(_WORKS),
}
"""Further measures of machines whose cavity is an oscillator."""
WITHOUT_IMPACTS = (*LOADS, "impact_loss", "impact_speed", "impact_speed_min")
"""Measures that are 0 without impacts; the other measures of impacts are NaN."""
MEANS = {f"{name}_mean": name for name in _LOSSES | _WORKS}
"""Name of an energy per forcing period -> name of the same energy per period of the orbit."""
MEASURES = {
    **COMMON,
    **DRIVEN,
    **{
        f"{name}_mean": Measure("energy", f"{what} per forcing period")
        for name, what in (_LOSSES | _WORKS).items()
    },
    **dict.fromkeys(BAND, Measure("length")),
}
KINDS = {name: measure.kind for name, measure in MEASURES.items()}
"""Kind of quantity of each measure."""
ANGLES = tuple(name for name, kind in KINDS.items() if kind == "angle")
"""Measures in radians, modulo 2 pi."""

# ------------------------------------------------------------------ labels of axes
SYMBOLS = {
    **{name: measure.label for name, measure in MEASURES.items() if measure.label},
    "w": "position $w$",
    "w_rate": "velocity $w'$",
    "v": "$v$",
    "v_rate": "$v'$",
    "frequency": r"frequency $\Omega$",
    "restitution": "restitution $r$",
    "friction": r"friction $\mu$",
    "gravity": r"gravity $\tilde g$",
    "mass_ratio": r"mass ratio $\varepsilon$",
    "forcing": "forcing $G$",
    "damping": r"damping $\lambda$",
}
"""Labels of measures, coordinates and parameters by name, in the field's notation."""
WORDS = {
    **{name: measure.words for name, measure in MEASURES.items() if measure.words},
    "half_width": "half-width of the cavity (clearance to either side)",
    "frequency": "excitation frequency",
    "base_amplitude": "amplitude of the base",
    "force_amplitude": "amplitude of the force",
}
"""Labels in words, for quantities with a unit."""
STARTS = {
    **{name: SYMBOLS[name] for name in ("v", "v_rate")},
    "w": "position $w$ of the start",
    "w_rate": "velocity $w'$ of the start",
    "phase": "phase of the start",
}
"""Labels of the coordinates of a start."""


def sign(name: str) -> str:
    """Return the symbol of a parameter alone, as on axes; its name if it has none."""
    _, dollar, symbol = SYMBOLS.get(name, "").partition("$")
    return dollar + symbol or name


# ------------------------------------------------------------------ forces at walls
def loads(
    speeds: np.ndarray,
    restitution: np.ndarray,
    mass: np.ndarray,
    at: Sequence[str],
    walls: Sequence[str],
    duration: np.ndarray,
    held: np.ndarray | float | None,
) -> dict[str, np.ndarray]:
    """Return measures of the forces at walls by name, (m,), and `impact_loss`, the energy lost at impacts.

    Parameters
    ----------
    speeds, restitution, mass : float array (m, l)
        For each impact of m solutions: the speed before it, the wall's restitution, the mass of the relative motion.
    at, walls : sequence of str
        The wall of each impact, and all walls, as they appear in names of impulses.
    duration : float array (m,)
        Length of the period.
    held : float array (m,) or float, optional
        Duration of an impact, with a force of half a sine: impulse = 2 F T/pi.
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
    """Return a hint, to end a sentence, how a machine gets a measure that it lacks; empty if there is none."""
    return (
        " (a peak force needs contact_time, the duration of an impact: in [model], of a declared machine among its parameters)"
        if name == "peak_force"
        else ""
    )
