"""What the formulas of a declared machine are asked before it becomes a machine; every refusal is a sentence that names the contact and the way out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.contacts.wall import Wall
from orbits.integrators.expressions import Values, derivatives, replaced, variables_of
from orbits.machines.page.formulas import PageError
from orbits.machines.page.patterns import Equations
from orbits.settings import FORMULAS

if TYPE_CHECKING:
    from orbits.symbols import Symbol

DRAWS = 8  # random states at which formulas are compared


class Draws:
    """Random states, phases and signs beside the machine's own parameters."""

    def __init__(self, equations: Equations, params: np.ndarray) -> None:
        generator = np.random.default_rng(14)
        self.equations = equations
        self.states = generator.uniform(-1.0, 1.0, (DRAWS, len(equations.states)))
        self.clock = generator.uniform(0.0, 2.0 * np.pi, DRAWS)
        self.signs = generator.choice([-1.0, 1.0], (DRAWS, len(equations.signed)))
        self.params = np.tile(params, (DRAWS, 1))

    def of(
        self,
        values: Sequence[Any],
        states: np.ndarray | None = None,
        clock: np.ndarray | None = None,
        signs: np.ndarray | None = None,
    ) -> np.ndarray:
        """Values, shape (DRAWS, count)."""
        numbers = np.hstack([self.params, self.signs if signs is None else signs])
        with np.errstate(all="ignore"):
            return Values(self.equations.layout, list(values))(
                self.states if states is None else states, self.clock if clock is None else clock, numbers
            )


def check_contacts(equations: Equations, params: np.ndarray) -> dict[tuple[int, int], int | None]:
    """Walls, frictions and switches against the motion; returns what impacts do to frictions and switches (`Alphabet.flips`)."""
    e, draws = equations, Draws(equations, params)
    flips: dict[tuple[int, int], int | None] = {}
    zero = {name: 0.0 for force in e.force.values() for name in variables_of(force)}
    _check_periods(draws, zero)
    _check_surfaces(draws)
    for j, force in e.force.items():
        what = e.contacts[j].described
        limit = draws.of([e.limit[j]])[:, 0]
        if np.all(limit < 0.0):
            raise PageError(f"{what}: the limit is {limit[0]:.4g}; give the largest force, 0 or above")
        (effect,) = derivatives([e.along(e.velocity[j], e.rates)], [force])
        (name,) = variables_of(force)
        if not any(name in variables_of(rate) for rate in e.rates):
            raise PageError(
                f"{what}: motion ignores contact.{e.contacts[j].name}; add the force to the rate of a velocity it acts on"
            )
        slopes = [row[0] for row in derivatives(e.rates, [force])]
        if any(name in variables_of(slope) for slope in (effect[0], *slopes)):
            raise PageError(
                f"{what}: motion must be affine in contact.{e.contacts[j].name} (force times a mass factor)"
            )
        sizes = draws.of([replaced(effect[0], zero)])[:, 0]
        if not np.all(sizes[np.isfinite(sizes)] > FORMULAS.zero):
            raise PageError(
                f"{what}: a positive contact.{e.contacts[j].name} must speed its velocity up; here it gives the acceleration "
                f"{float(np.nanmin(sizes)):.3g}. Change the sign of the force in motion, or of the velocity"
            )
    for j, contact in enumerate(e.contacts):
        if not isinstance(contact, Wall):
            continue
        what = contact.described
        rate = e.along(e.gap[j], e.rates)
        if any(name in variables_of(rate) for name in zero):
            raise PageError(
                f"{what}: the rate of its gap contains a friction force; a gap is a distance, not a velocity"
            )
        after = e.impact(j)
        sizes = draws.of([e.toward(rate, e.push[j])])[:, 0]
        if not np.all(np.abs(sizes[np.isfinite(sizes)]) > FORMULAS.zero):
            raise PageError(
                f"{what}: an impulse along push = {dict(contact.push)!r} does not change the rate of its gap; "
                "push the velocities of the bodies that meet there"
            )
        table = draws.of([e.gap_rate(j), e.restitution[j], e.gap[j], *after])
        later = draws.of([e.gap_rate(j), e.gap[j]], states=table[:, 3:])
        if np.abs(later[:, 1] - table[:, 2]).max() > FORMULAS.same * (1.0 + np.abs(table[:, 2]).max()):
            raise PageError(f"{what}: the impulse moves the gap itself; push rates of positions only")
        if np.abs(later[:, 0] + table[:, 1] * table[:, 0]).max() > FORMULAS.same * (
            1.0 + np.abs(table[:, 0]).max()
        ):
            raise PageError(f"{what}: the rate of its gap must be linear in what push changes")
        for k in e.signed:
            flip = _flip(draws, e.velocity[k] if k in e.velocity else e.surface[k], table)
            if flip != 0:
                flips[j, k] = flip
    return flips


def _check_periods(draws: Draws, zero: Mapping[str, float]) -> None:
    """Whether everything on the page has the period 2 pi in the phase."""
    e = draws.equations
    if e.phase_rate is None:
        return
    told = [(f"motion's rate of {n}", replaced(r, zero)) for n, r in zip(e.states, e.rates)]
    for table, what in ((e.gap, "gap"), (e.velocity, "velocity"), (e.limit, "limit"), (e.surface, "surface")):
        told += [(f"the {what} of {e.contacts[j].described}", value) for j, value in table.items()]
    values = [value for _, value in told]
    here, there = draws.of(values), draws.of(values, clock=draws.clock + 2.0 * np.pi)
    for (what, _), a, b in zip(told, here.T, there.T):
        with np.errstate(invalid="ignore"):
            gap = np.abs(a - b)
        if np.nanmax(gap, initial=0.0) > FORMULAS.same * (1.0 + np.nanmax(np.abs(a), initial=0.0)):
            k = int(np.nanargmax(gap))
            raise PageError(
                f"{what} does not have the period 2 pi in the phase: at phase = {draws.clock[k]:.4g} it is {a[k]:.6g}, 2 pi later "
                f"{b[k]:.6g}; let phase_rate be the lowest frequency of the forcing, and write the others as whole multiples of the phase"
            )


def _check_surfaces(draws: Draws) -> None:
    """Whether switches switch something, and whether contacts that would always act at once are declared apart."""
    e = draws.equations
    for j, surface in e.surface.items():
        what, name = e.contacts[j].described, e.contacts[j].name
        if not variables_of(surface) & {*e.layout.states, e.layout.clock}:
            raise PageError(
                f"{what}: its surface is a constant; give a function of the states that changes sign"
            )
        known = set().union(*(variables_of(v) for v in (*e.rates, *e.limit.values())))
        if not variables_of(e.sign[j]) & known:
            raise PageError(
                f"{what}: motion ignores contact.{name}; use it where the law changes, or leave the switch out"
            )
    pairs = [*e.velocity.items(), *e.surface.items()]
    for place, (j, one) in enumerate(pairs):
        for k, other in pairs[place + 1 :]:
            if j not in e.velocity or not _proportional(draws, one, other):
                continue
            both = f"{e.contacts[j].described} and {e.contacts[k].described}"
            if k in e.velocity:
                raise PageError(
                    f"{both} have the same velocity; declare one DryFriction whose limit is the sum of theirs"
                )
            raise PageError(
                f"{both} change together; leave the switch out: what turns with the velocity belongs into the friction's limit, "
                "for example limit=lambda state, phase, p: p.friction + p.drag * state.v**2"
            )


def _proportional(draws: Draws, one: Symbol, other: Symbol) -> bool:
    """Whether two quantities differ by a constant factor only."""
    table = draws.of([one, other])
    with np.errstate(all="ignore"):
        ratio = table[:, 0] / table[:, 1]
    return bool(
        np.all(np.isfinite(ratio)) and np.any(ratio) and np.ptp(ratio) < FORMULAS.same * np.abs(ratio).max()
    )


def riding(equations: Equations, params: np.ndarray) -> frozenset[tuple[int, int]]:
    """Switches whose surface moves with the velocity of a friction (`Alphabet.rides`): its rate is that velocity times a number."""
    e, draws = equations, Draws(equations, params)
    forces = set().union(*map(variables_of, e.force.values()))
    found = set()
    for j, surface in e.surface.items():
        rate = e.along(surface, e.rates)
        if forces & variables_of(rate):
            continue
        for k, velocity in e.velocity.items():
            if _proportional(draws, rate, velocity):
                found.add((j, k))
    return frozenset(found)


def _flip(draws: Draws, value: Symbol, table: np.ndarray) -> int | None:
    """0: the impact leaves the velocity (or surface) alone; -1, +1: its sign afterwards; None: it may change to either."""
    before = draws.of([value])[:, 0]
    after = draws.of([value], states=table[:, 3:])[:, 0]
    if np.abs(after - before).max() < FORMULAS.same * (1.0 + np.abs(before).max()):
        return 0
    ratio = before / table[:, 0]  # velocity = ratio * rate of the gap, everywhere
    if np.all(np.isfinite(ratio)) and np.ptp(ratio) < FORMULAS.same * np.abs(ratio).max():
        return 1 if ratio[0] > 0.0 else -1  # after the impact the gap opens
    return None
