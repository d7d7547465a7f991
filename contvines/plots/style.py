"""What things look like in every picture: line styles, marks of special points, names of axes."""

import re
from dataclasses import dataclass
from typing import Any

from ..events.kinds import KINDS

# line styles of the states of an orbit; what nobody has asked for is drawn solid, and named
LINES: dict[str, Any] = {"stable": "-", "unknown": "-", "unstable": (0, (5, 2.2)), "virtual": (0, (1, 1.8))}
WIDTHS = {"stable": 1.25, "unknown": 1.1, "unstable": 0.88, "virtual": 0.88}  # in units of lines.linewidth
STATE_COLORS = {"stable": "#0b3c6f", "unknown": "#4d4d4d", "unstable": "#d9484b", "virtual": "#8a8a8a"}
PROVED = {"color": "#7fc97f", "alpha": 0.45}  # beneath what is proved
STATES = {
    "stable": "stable",
    "unknown": "stability not computed",
    "unstable": "unstable",
    "virtual": "virtual (beyond a border)",
}
STATE_OF = {True: "stable", False: "unstable", None: "unknown"}


@dataclass(frozen=True)
class Mark:
    """How a kind of special point is drawn."""

    name: str
    marker: str
    filled: bool = False


MARKS = {kind.name: Mark(kind.text, kind.marker, kind.filled) for kind in KINDS.values()}
PLAIN = Mark("special point", "o")

# axis labels in the field's notation; anything else is shown by its own name
SYMBOLS = {
    "amplitude": "amplitude $C$",
    "C2": "$C^2$",
    "B": "velocity at the first impact $B$",
    "B_post": "velocity after impact $B^+$",
    "B_pre": "velocity before impact $B^-$",
    "B_mean": "mean velocity at impacts $B$",
    "w": "position $w$",
    "w_rate": "velocity $w'$",
    "v": "$v$",
    "v_rate": "$v'$",
    "max_abs_w": r"largest $|w|$",
    "max_abs_q1": r"largest $|q_1|$ in units of $b$",
    "phase": r"forcing phase at the first event",
    "impact_loss": "loss at impacts per period of the orbit",
    "friction_loss": "loss by friction per period of the orbit",
    "input_work": "work of the base per period of the orbit",
    "damping_loss": "loss in the damper per period of the orbit",
    "force_work": "work of the equivalent force per period of the orbit",
    "grounded_damping_loss": "loss in a grounded damper per period of the orbit",
    "impact_loss_mean": "loss at impacts per forcing period",
    "friction_loss_mean": "loss by friction per forcing period",
    "input_work_mean": "work of the base per forcing period",
    "damping_loss_mean": "loss in the damper per forcing period",
    "force_work_mean": "work of the equivalent force per forcing period",
    "grounded_damping_loss_mean": "loss in a grounded damper per forcing period",
    "impact_speed": "fastest impact $|w'_-|$",
    "frequency": r"frequency $\Omega$",
    "restitution": "restitution $r$",
    "friction": r"friction $\mu$",
    "gravity": r"gravity $\tilde g$",
    "mass_ratio": r"mass ratio $\varepsilon$",
    "forcing": "forcing $G$",
    "damping": r"damping $\lambda$",
}


# the same in words, for axes that have a unit
WORDS = {
    "max_abs_q1": "largest displacement of the oscillator",
    "max_abs_w": "largest relative displacement",
    "amplitude": "amplitude",
    "impact_speed": "fastest impact",
    "half_width": "half-width of the cavity (clearance to either side)",
    "frequency": "excitation frequency",
    "base_amplitude": "amplitude of the base",
    "force_amplitude": "amplitude of the force",
}


def axis_label(name: str, short: bool = False, unit: str | None = None) -> str:
    """The label of an axis that shows `name`; the symbol alone, where it has one and room is short. With a unit: words."""
    if unit:
        words = WORDS.get(name) or SYMBOLS.get(name, name.replace("_", " "))
        raised = re.sub(r"\^(-?\d+)", r"$^{\1}$", unit)
        return f"{name.replace('_', ' ') if short else words} [{raised}]"
    label = SYMBOLS.get(name, name.replace("_", " "))
    if short and "$" in label:
        return label[label.index("$") : label.rindex("$") + 1]
    return label
