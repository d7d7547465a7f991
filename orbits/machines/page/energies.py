"""What the energy in a machine file tells of its contacts: the mass behind an impact, and the power that friction takes.

With the energy E, quadratic in the speeds, and a contact whose unit of force changes the states at the rates d, the force is conjugate to the
contact's speed s: the mass of the relative motion is m = (d . H d) / (ds/dx . d)^2 with the Hessian H of E, an impulse of J newton seconds changes s
by J/m, and a unit of the contact's own force is (d . H d) / (ds/dx . d) newton. Work of what moves a wall or a belt is not counted.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from orbits.integrators.expressions import constant, derivatives, variables_of
from orbits.machines.page.formulas import PageError
from orbits.symbols import Symbol

CONTACT = "contact_time"
"""Name of the parameter that is the duration of an impact, in seconds; it moves nothing."""

if TYPE_CHECKING:
    from orbits.machines.page.patterns import Equations, Pattern


def _curvature(e: Equations, direction: list[Symbol]) -> Symbol:
    assert e.energy is not None
    return e.toward(e.toward(e.energy, direction), direction)


def impact_mass(e: Equations, wall: int) -> Symbol:
    """Mass of the relative motion at a wall."""
    push = e.push[wall]
    turned = e.toward(e.gap_rate(wall), push)
    return _curvature(e, push) / (turned * turned)


def body_masses(e: Equations) -> list[tuple[str, Symbol]]:
    """Speeds that a wall or a friction changes, by name, and the mass that moves with each; none without an energy."""
    if e.energy is None:
        return []
    forces = set().union(*map(variables_of, e.force.values()))
    moved = [bool(forces & variables_of(rate)) for rate in e.rates]
    found = []
    for k, name in enumerate(e.states):
        if moved[k] or any(push[k].number != 0.0 for push in e.push.values()):
            unit = [constant(float(k == place)) for place in range(len(e.states))]
            found.append((name, _curvature(e, unit)))
    return found


def friction_power(pattern: Pattern) -> Symbol:
    """Power that the frictions take in a pattern."""
    e, total = pattern.equations, constant(0.0)
    for j, force in e.force.items():
        if j in pattern.stuck or j in pattern.absent:
            continue
        push = [row[0] for row in derivatives(e.rates, [force])]
        newtons = _curvature(e, push) / e.toward(e.velocity[j], push)
        total = total - newtons * pattern.forces[j] * e.velocity[j]
    return total


def load_names(e: Equations, parameters: Collection[str]) -> tuple[str, ...]:
    """Measures of the contacts that a page has: those of forces and energies need its energy, a peak force the duration of an impact."""
    if e.energy is None:
        return ("impact_rate",) if e.gap else ()
    found: list[str] = []
    if e.gap:
        letters = [e.contacts[j].letter for j in e.gap]
        found += ["impact_rate", "impulse", *(f"impulse_{letter}" for letter in letters if len(letters) > 1)]
        found += ["impact_energy", "impact_loss", "mean_force"]
        found += ["peak_force"] if CONTACT in parameters else []
    return (*found, *(["friction_loss"] if e.force else []), *(["work_rate"] if found or e.force else []))


UNITS = {
    "impact_rate": "Hz", "impulse": "N s", "impact_energy": "J", "impact_loss": "J", "friction_loss": "J", "mean_force": "N",
    "work_rate": "W", "peak_force": "N",
}  # fmt: skip
"""Of these measures; that of ``impulse_R`` is that of ``impulse``."""


def check_energy(e: Equations, values: list[float], wall: int) -> None:
    """Refuse an energy in which a wall pushes no mass.

    Raises
    ------
    PageError
    """
    if not all(value > 0.0 for value in values):
        raise PageError(
            f"energy: the push of {e.contacts[wall].described} moves a mass of {min(values):.4g}; give the energy of all bodies, "
            "their kinetic energies among it, in joules"
        )
