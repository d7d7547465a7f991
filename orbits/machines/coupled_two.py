"""Two absorbers with dry friction in the two cavities of one driven oscillator, in kilograms, millimetres and hertz.

    M q'' = k (e - q) + c (e' - q') + m1 (q - x1)-friction + m2 (q - x2)-friction,    x_i'' = g mu_i sign(q' - x_i'),    e = E sin(2 pi f t),

with |q - x_i| <= clearance_i and Newton's restitution at the walls. Impacts conserve momentum: at an impact of absorber i, the jump of q' is
-m_i/M times that of x_i'. Letters: L1, R1, L2, R2 for impacts on the left and right walls; t1, s1, u1 and t2, s2, u2 for turns, sticks and
slips. With a light second absorber the machine becomes `coupled` with mass_ratio = m1/M. Its flow is integrated like that of any declared
machine (`orbits.machines.page`): two absorbers stick and slide in nine combinations.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.wall import Wall
from orbits.machines.page.machine import Machine
from orbits.symbols import cos, sin

if TYPE_CHECKING:
    from orbits.machines.page.page import Named, States
    from orbits.symbols import Plain

TURN = 6.283185307179586  # radians

PARAMETERS = {  # name: (usual value, unit, meaning)
    "base_amplitude": (0.3, "mm", "amplitude of the base"),
    "frequency": (8.0, "Hz", "excitation frequency"),
    "natural_frequency": (8.0, "Hz", "of the oscillator without absorbers"),
    "damping_ratio": (0.007, "", "of the oscillator without absorbers"),
    "oscillator_mass": (3.8, "kg", ""),
    "absorber_mass_1": (0.032, "kg", ""),
    "absorber_mass_2": (0.016, "kg", ""),
    "clearance_1": (15.0, "mm", "from the middle of the cavity to either wall"),
    "clearance_2": (10.0, "mm", "from the middle of the cavity to either wall"),
    "restitution_1": (0.6, "", "Newton's coefficient"),
    "restitution_2": (0.6, "", "Newton's coefficient"),
    "friction_1": (0.1, "", "Coulomb coefficient"),
    "friction_2": (0.1, "", "Coulomb coefficient"),
    "gravity": (9.81, "m/s^2", ""),
    "contact_time": (0.5, "ms", "duration of an impact, which only its peak force depends on"),
}
# millimetres and metres per second give unknowns of similar size, as continuation needs them
STATES = {"q": "mm", "x1": "mm", "x2": "mm", "q_rate": "m/s", "x1_rate": "m/s", "x2_rate": "m/s"}


def _motion(state: States, phase: Plain, p: Named, contact: Named) -> tuple[Plain, ...]:
    q, _, _, v, v1, v2 = state
    rate = TURN * p.natural_frequency
    ahead = p.base_amplitude * sin(phase) - q
    faster = p.base_amplitude * p.frequency * cos(phase) - v
    drag = (p.absorber_mass_1 * contact.floor1 + p.absorber_mass_2 * contact.floor2) / p.oscillator_mass
    push = rate * (rate * ahead + 2 * p.damping_ratio * faster) + drag
    return v, v1, v2, push, -contact.floor1, -contact.floor2


def _energy(state: States, phase: Plain, p: Named) -> Plain:
    """Return the kinetic energies and that of the spring."""
    stiffness = p.oscillator_mass * (TURN * p.natural_frequency) ** 2
    stretch = state.q - p.base_amplitude * sin(phase)
    oscillator = p.oscillator_mass * state.q_rate**2 + stiffness * stretch**2
    return 0.5 * (oscillator + p.absorber_mass_1 * state.x1_rate**2 + p.absorber_mass_2 * state.x2_rate**2)


def _wall(absorber: int, side: int) -> Wall:
    """Return the left (side = 1) or the right wall of an absorber's cavity."""

    def gap(state: States, phase: Plain, p: Named) -> Plain:
        return getattr(p, f"clearance_{absorber}") - side * (state.q - getattr(state, f"x{absorber}"))

    def back(state: States, phase: Plain, p: Named) -> Plain:
        return -side * getattr(p, f"absorber_mass_{absorber}") / p.oscillator_mass

    letter = f"{'L' if side > 0 else 'R'}{absorber}"
    return Wall(letter, gap, {"q_rate": back, f"x{absorber}_rate": side}, f"restitution_{absorber}")


def _floor(absorber: int) -> DryFriction:
    def speed(state: States, phase: Plain, p: Named) -> Plain:
        return state.q_rate - getattr(state, f"x{absorber}_rate")

    def limit(state: States, phase: Plain, p: Named) -> Plain:
        return getattr(p, f"friction_{absorber}") * p.gravity

    return DryFriction(
        f"floor{absorber}", speed, limit, letters=(f"t{absorber}", f"s{absorber}", f"u{absorber}")
    )


coupled_two = Machine(
    name="coupled_two",
    states=tuple(STATES),
    parameters={name: value for name, (value, _, _) in PARAMETERS.items()},
    phase_rate="frequency",
    motion=_motion,
    contacts=[*(_wall(absorber, side) for absorber in (1, 2) for side in (1, -1)), _floor(1), _floor(2)],
    mirror={"L1": "R1", "L2": "R2"},
    starts={name: (-5.0, 5.0) if unit == "mm" else (-0.5, 0.5) for name, unit in STATES.items()},
    energy=_energy,
    response="max_abs_q",
    units=STATES | {name: unit for name, (_, unit, _) in PARAMETERS.items() if unit},
)
