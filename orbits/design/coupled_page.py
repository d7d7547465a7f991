"""The coupled machine as a declared one, the bare oscillator beside it: for excitations that closed forms do not know.

The equations are those of `orbits.machines.coupled`, in its own numbers and counted as it counts; the bare oscillator is two further states.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.wall import Wall
from orbits.machines.catalogue import usual
from orbits.machines.page.formulas import Named, States
from orbits.machines.page.machine import Machine
from orbits.symbols import cos, sin

if TYPE_CHECKING:
    from orbits.symbols import Plain


def _motion(state: States, phase: Plain, p: Named, contact: Named) -> tuple[Plain, ...]:
    q1, _, v1, v2, bare, bare_rate = state
    damping = p.mass_ratio * p.damping
    base = p.mass_ratio * p.forcing * (sin(phase) + p.excitation * damping * p.frequency * cos(phase))
    pull = p.gravity * sin(p.slope) - contact.floor
    return (
        v1,
        v2,
        base - damping * v1 - q1 - p.mass_ratio * pull,
        pull,
        bare_rate,
        base - damping * bare_rate - bare,
    )


def _wall(letter: str, side: int) -> Wall:
    push = {"v1": lambda state, phase, p: -side * p.mass_ratio, "v2": side}
    return Wall(letter, lambda state, phase, p: 1 - side * (state.q1 - state.q2), push, "restitution")


@cache
def coupled_page() -> Machine:
    """The machine; its parameters are those of `orbits.Coupled`."""
    model, given = usual("coupled")
    floor = DryFriction(
        "floor", lambda s, phase, p: s.v1 - s.v2, lambda s, phase, p: p.friction * p.gravity * cos(p.slope)
    )
    return Machine(
        name="coupled_and_bare",
        states=("q1", "q2", "v1", "v2", "bare", "bare_rate"),
        parameters=model.named(model.vector(given)),
        phase_rate="frequency",
        motion=_motion,
        contacts=[_wall("L", 1), _wall("R", -1), floor],
        energy=lambda s, phase, p: 0.5 * (s.v1**2 + p.mass_ratio * s.v2**2 + s.q1**2),
    )
