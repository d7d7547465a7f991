"""Periodic motions of vibro-impact absorbers: words, impact maps, margins, simulation, theory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contvines.shared.on_demand import on_demand

if TYPE_CHECKING:
    from orbits import attractors, design, machines, multiple_scales, simulation, symbols, theory, words
    from orbits.contacts.dry_friction import DryFriction
    from orbits.contacts.switch import Switch
    from orbits.contacts.wall import Wall
    from orbits.design.scales import Scales
    from orbits.machines.absorber import Absorber
    from orbits.machines.cavity import Cavity
    from orbits.machines.coupled import Coupled
    from orbits.machines.coupled_two import coupled_two
    from orbits.machines.page.machine import Machine
    from orbits.machines.parameters import ParameterError
    from orbits.machines.structure import structure
    from orbits.orbit import Orbit
    from orbits.problem import OrbitProblem
    from orbits.words import Word, WordError

__all__ = [
    "Absorber",
    "Cavity",
    "Coupled",
    "DryFriction",
    "Machine",
    "Orbit",
    "OrbitProblem",
    "ParameterError",
    "Scales",
    "Switch",
    "Wall",
    "Word",
    "WordError",
    "attractors",
    "coupled_two",
    "design",
    "machines",
    "multiple_scales",
    "simulation",
    "structure",
    "symbols",
    "theory",
    "words",
]

FACTORIES = {
    "orbits.flows.page.smooth:rebuild": "orbits.flows.page.smooth:rebuild",
    "orbits.problem:rebuild": "orbits.problem:rebuild",
    "orbits.cycles.stuck_problem:rebuild": "orbits.problem:rebuild",
    "orbits.stuck_problem:rebuild": "orbits.problem:rebuild",
    "orbits.declared.stored:rebuild": "orbits.problem:rebuild",
    "orbits.machines.declared.stored:rebuild": "orbits.problem:rebuild",
}
"""Functions that rebuild problems from descriptions: name in a file -> the function's place; names of earlier versions are kept for their files."""
_SUB_PACKAGES = (
    "attractors",
    "design",
    "machines",
    "multiple_scales",
    "simulation",
    "symbols",
    "theory",
    "words",
)
__getattr__ = on_demand(
    __name__,
    {
        "Absorber": "orbits.machines.absorber",
        "Cavity": "orbits.machines.cavity",
        "Coupled": "orbits.machines.coupled",
        "DryFriction": "orbits.contacts.dry_friction",
        "Machine": "orbits.machines.page.machine",
        "Orbit": "orbits.orbit",
        "OrbitProblem": "orbits.problem",
        "ParameterError": "orbits.machines.parameters",
        "Scales": "orbits.design.scales",
        "Switch": "orbits.contacts.switch",
        "Wall": "orbits.contacts.wall",
        "Word": "orbits.words",
        "WordError": "orbits.words.alphabet",
        "coupled_two": "orbits.machines.coupled_two",
        "structure": "orbits.machines.structure",
        **{name: f"orbits.{name}" for name in _SUB_PACKAGES},
    },
)


def __dir__() -> list[str]:
    return __all__
