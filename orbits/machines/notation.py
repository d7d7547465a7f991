"""How parameters and measures of the built-in machines are written on axes: in the field's notation."""

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
    "impact_rate": "impacts per unit of time",
    "impulse": "largest impulse",
    "impulse_left": "largest impulse at the left wall",
    "impulse_right": "largest impulse at the right wall",
    "impact_energy": "energy of the hardest impact",
    "mean_force": "mean force at the walls",
    "work_rate": "power taken by impacts and friction",
    "peak_force": "peak force of the hardest impact",
    "frequency": r"frequency $\Omega$",
    "restitution": "restitution $r$",
    "friction": r"friction $\mu$",
    "gravity": r"gravity $\tilde g$",
    "mass_ratio": r"mass ratio $\varepsilon$",
    "forcing": "forcing $G$",
    "damping": r"damping $\lambda$",
}

#: the same in words, of numbers that have a unit
WORDS = {
    "max_abs_q1": "largest displacement of the oscillator",
    "max_abs_w": "largest relative displacement",
    "amplitude": "amplitude",
    "impact_speed": "fastest impact",
    "impact_rate": "impacts per second",
    "impulse": "largest impulse",
    "impulse_left": "largest impulse at the left wall",
    "impulse_right": "largest impulse at the right wall",
    "impact_energy": "energy of the hardest impact",
    "mean_force": "mean force at the walls",
    "work_rate": "power taken by impacts and friction",
    "peak_force": "peak force of the hardest impact",
    "half_width": "half-width of the cavity (clearance to either side)",
    "frequency": "excitation frequency",
    "base_amplitude": "amplitude of the base",
    "force_amplitude": "amplitude of the force",
}


def sign(name: str) -> str:
    """The symbol of a parameter alone, as on axes; its name where it has none."""
    _, dollar, symbol = SYMBOLS.get(name, "").partition("$")
    return dollar + symbol or name


#: of the coordinates of a start
STARTS = {
    **{name: SYMBOLS[name] for name in ("v", "v_rate")},
    "w": "position $w$ of the start",
    "w_rate": "velocity $w'$ of the start",
    "phase": "phase of the start",
}
