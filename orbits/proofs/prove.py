"""Prove orbits and special points that were computed in floating point.

The stuck absorber moves with the cavity, so only its friction margin has to be proved. The push against friction is the bias plus a harmonic of
the forcing, whose largest value is known in closed form.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.proofs.admissible import NOTHING, Zero, examine
from orbits.proofs.balls import Given, as_balls, ball, decimal, precision
from orbits.proofs.checks import check_parameters, check_symmetry, mirrored, motif_of, require_mirror
from orbits.proofs.enclosing import Box, enclose, refine
from orbits.proofs.equations import Motif, System, Varying
from orbits.proofs.jets import sqrt
from orbits.proofs.merging import merged
from orbits.proofs.obstacles import Obstacle, ProofError, Remedy, Step
from orbits.proofs.proof import Proof, conditions
from orbits.proofs.special import (
    AtBorder,
    AtMultiplier,
    AtPair,
    AtParameter,
    Family,
    Normal,
    Vanishing,
    eigenpair,
    eigenvector,
    touching_phase,
    vanishing_margin,
)
from orbits.proofs.special import chain as maps_of
from orbits.proofs.stability import basis_texts, stable
from orbits.proofs.tiles import crossing
from orbits.settings import PROVING

if TYPE_CHECKING:
    from collections.abc import Callable

    from flint import arb

    from orbits.proofs.elimination import Solution
    from orbits.proofs.flights import Flights
    from orbits.proofs.jets import Number, Row


MOST_BITS = 6144  # largest precision
FLOATING = 64  # bits of computations that need no more than floating-point accuracy
MULTIPLIERS = {"fold": 1, "symmetry-breaking": -1, "period-doubling": -1}


def prove_orbit(
    machine: str,
    events: Sequence[str],
    modes: Sequence[int],
    periods: int,
    nodes: np.ndarray,
    parameters: Mapping[str, Given],
    *,
    half: bool = False,
    frictionless: bool = False,
    bits: int | None = None,
) -> Proof:
    """Prove existence, local uniqueness, reality and stability of an orbit.

    Parameters
    ----------
    machine : str
    events, modes : sequences of str and of int
        The word over the whole period: letters, and the mode after each event.
    periods : int
        Forcing periods.
    nodes : float array (L, n)
        The computed nodes.
    parameters : dict
        Name -> float (stands for its shortest decimal), exact decimal as text, or ball (middle, radius).
    half : bool
        The orbit is symmetric: solve for half the word.
    frictionless : bool
        The relative velocity may change sign in flights.
    bits : int, optional
        Precision at the beginning; it is doubled while this helps.

    Returns
    -------
    Proof

    Raises
    ------
    ProofError
        If the machine has no flights in closed form, or a parameter is out of range.
    """
    motif = motif_of(machine, events, modes, periods, half, frictionless)
    given = {name: decimal(value) for name, value in parameters.items()}
    start = nodes[: len(motif)]
    check_symmetry(motif, given)
    if half:
        require_mirror(motif, events, modes, nodes, given)
    proof = Proof("orbit", motif, given)

    def attempt(at: int) -> Proof:
        p = {name: ball(value) for name, value in given.items()}
        check_parameters(motif, p)
        system = System(motif, p)
        z, _ = _refined(system, start, [], at)
        box = enclose(system, z, [], at)
        balls, _ = box.balls()
        reality = examine(motif, p, balls)
        steady, obstacle = stable(system, balls)
        broken = (reality.broken.name, reality.broken.event) if reality.broken else None
        obstacles = (*reality.obstacles(), *([obstacle] if obstacle else []))
        return replace(
            proof,
            box=box,
            real=reality.real,
            stable=steady,
            broken=broken,
            obstacles=obstacles,
            basis=tuple(basis_texts(system, balls)),
            bits=at,
        )

    return _with_bits(attempt, proof, bits or 160 + 8 * len(motif), given)


def prove_special(
    kind: str,
    motif: Motif,
    nodes: np.ndarray,
    parameters: Mapping[str, Given],
    varying: Varying,
    value: float,
    *,
    margin: tuple[str, int] | None = None,
    bits: int | None = None,
) -> Proof:
    """Prove a special point as a regular zero of its defining system, and decide whether its orbit is real.

    Parameters
    ----------
    kind : str
        "fold", "symmetry-breaking", "period-doubling", "neimark-sacker" or the kind of a border.
    motif : Motif
    nodes : float array (l, n)
        Nodes of the motif's events.
    parameters : dict
        Parameters of the machine; values of those that vary are ignored.
    varying : Varying
        The parameter that is an unknown.
    value : float
        Its computed value at the special point.
    margin : (str, int), optional
        For a border: name (`orbits.proofs.special.Vanishing`) and event of the margin that vanishes.
    bits : int, optional
        Precision at the beginning; it is doubled while this helps.

    Raises
    ------
    ProofError
        If the part of the word does not suit the kind, or a parameter is out of range.
    """
    if kind in ("symmetry-breaking", "period-doubling") and motif.half is not (kind == "symmetry-breaking"):
        part = "half of the word of a symmetric orbit" if kind == "symmetry-breaking" else "the whole word"
        raise ProofError(f"a {kind} is proved on {part}")
    given = {name: decimal(number) for name, number in parameters.items() if name not in varying.numbers}
    check_symmetry(motif, given, varying)
    if margin is not None and len(motif):
        with precision(FLOATING):
            flights = motif.flights({n: ball(v) for n, v in given.items()} | varying.at(ball(value)))
            room = {side: float(ball(0) + flights.room[side]) for side in (1, -1)}
        motif, nodes, margin = merged(motif, nodes, margin, room) or (motif, nodes, margin)
    proof = Proof(kind, motif, given, varying)

    def attempt(at: int) -> Proof:
        family = Family(motif, {name: ball(number) for name, number in given.items()}, varying)
        numbers = family.numbers(ball(value))
        check_parameters(motif, numbers)
        if not len(motif):
            return _slip(proof, family, value, at)
        x = as_balls(nodes)
        vanishing = vanishing_margin(motif, numbers, x, *margin) if margin else None
        system, z, e, turn = _defining(kind, family, x, value, vanishing)
        z, e = _refined(system, nodes, e, at, z)
        box = enclose(system, z, e, at)
        balls, extras = box.balls()
        if kind == "neimark-sacker" and extras[1].sin().contains(0):
            raise Obstacle(Step.EXISTENCE, Remedy.DEGENERATE, detail="the multipliers are real")
        inside = [node[: motif.node] for node in balls]
        zero = NOTHING
        if vanishing is not None:
            zero = Zero(
                vanishing.name, vanishing.event, extras[1] if vanishing.inside else None, vanishing.side
            )
        reality = examine(motif, family.numbers(extras[0]), inside, zero)
        broken = (reality.broken.name, reality.broken.event) if reality.broken else None
        turning = turn if kind == "fold" else None
        chain = crossing(family, z, e[0], at, turning, pair=kind == "neimark-sacker")
        chain[1]["kind"] = kind if vanishing is None else "border"
        if vanishing is not None:
            chain[1]["conditions"] = conditions(motif, vanishing)
        return replace(
            proof,
            kind=vanishing.kind if vanishing else kind,
            box=box,
            real=reality.real,
            broken=broken,
            obstacles=tuple(reality.obstacles()),
            chain=tuple(chain),
            bits=at,
        )

    return _with_bits(attempt, proof, bits or 192 + 8 * len(motif), given)


def _slip(proof: Proof, family: Family, value: float, bits: int) -> Proof:
    """Prove the point at which the stuck absorber begins to slip: the largest push equals the largest friction."""
    flights = family.motif.flights(family.numbers(ball(value)))
    one, other = (float(flights.resting(phase)[0].mid()) for phase in (ball(0), ball(float(np.pi / 2))))
    bias = float(ball(0) + flights.bias)
    side = min((1, -1), key=lambda s: float(ball(0) + flights.limit[s]) - s * bias)
    phase = float(np.arctan2(other - bias, one - bias)) + (0.0 if side > 0 else float(np.pi))
    system = AtSlip(family, side)
    z, e = refine(system, [[ball(phase)]], [ball(value)], bits)
    if not abs(float(e[0]) - value) < PROVING.near:
        raise Obstacle(Step.REFINEMENT, Remedy.START)
    box = enclose(system, z, e, bits)
    chain = crossing(family, [], e[0], bits)
    sides = (1, -1) if mirrored(proof.parameters, family.varying) else (side,)
    chain[1] |= {"kind": "border", "conditions": [["flight", 0, side] for side in sides]}
    return replace(proof, box=box, real=True, chain=tuple(chain), bits=bits)


def _defining(
    kind: str, family: Family, x: list[list[arb]], value: float, vanishing: Vanishing | None
) -> tuple[System, list[list[arb]], list[arb], Normal | None]:
    """Return the defining system, start values of its unknowns (nodes, further ones), and the normalised component of the eigenvector."""
    motif, numbers = family.motif, family.numbers(ball(value))
    if vanishing is not None:
        extras = [ball(value)]
        if vanishing.inside:
            extras.append(touching_phase(motif, numbers, x, vanishing))
        return AtBorder(family, vanishing), x, extras, None
    factors = maps_of(motif, numbers, x)
    if kind == "neimark-sacker":
        phi, normal, angle = eigenpair(factors)
        system: System = AtPair(family, normal)
        extras = [ball(value), ball(angle)]
    else:
        mu = MULTIPLIERS[kind]
        phi, normal = eigenvector(factors, mu)
        system, extras = AtMultiplier(family, mu, normal), [ball(value)]
    return system, [a + b for a, b in zip(x, phi)], extras, normal


def _refined(
    system: System, nodes: np.ndarray, extras: Sequence[arb], bits: int, start: list[list[arb]] | None = None
) -> Solution:
    """Refine the computed orbit by Newton's method; raise an `Obstacle` if the result is a different orbit."""
    z = start or as_balls(nodes)
    z, e = refine(system, z, extras, bits)
    n = system.motif.node
    away = max(
        abs(float(found) - float(given)) / (1.0 + abs(float(given)))
        for part, node in zip(z, nodes)
        for found, given in zip(part[:n], node)
    )
    if extras:
        away = max(away, abs(float(e[0] - extras[0])))
    if not away < PROVING.near:
        raise Obstacle(
            Step.REFINEMENT, Remedy.START, detail=f"the nearest orbit is {away:.1g} away from these nodes"
        )
    return z, e


def _with_bits(attempt: Callable[[int], Proof], proof: Proof, bits: int, given: Mapping[str, Given]) -> Proof:
    """Repeat `attempt` with doubled precision until all is decided or more bits do not help; return the best proof."""
    best, tries = replace(proof, bits=bits), 0
    wide = any(isinstance(value, tuple) for value in given.values())
    while True:
        try:
            with precision(bits):
                best = attempt(bits)
                open_ = best.real is None or (best.stable is None and best.kind == "orbit")
            if not open_ or wide:
                return best
            tries += 1
        except Obstacle as obstacle:
            best = replace(best, obstacles=(obstacle,), bits=bits) if best.box is None else best
            if obstacle.remedy is Remedy.START:
                return best
            if obstacle.step is Step.REFINEMENT:
                tries += 1
        bits *= 2
        if tries >= 2 or bits > MOST_BITS:
            return best


class AtSlip(AtParameter):
    """Defining system of the limit of sticking; unknowns are the phase of the largest push on the stuck absorber, and the parameter."""

    def __init__(self, family: Family, side: int) -> None:
        super().__init__(family)
        self.k = self.length = 1

        def row(z: Row, extras: Row) -> Number:
            flights = self.prepare(extras)
            return flights.limit[side] - side * flights.resting(z[0])[0]

        self.borders = ((0, row),)

    def block(self, i: int, shared: Flights, z: Row, following: Row, extras: Row) -> list[Any]:
        """Return the time derivative of the push, which vanishes at its extremum."""
        return [shared.resting(z[0])[1]]

    def closing(self, z: Row, extras: Row) -> list[Any]:
        """Return the same phase: there is no map to close."""
        return list(z)


def prove_stuck(machine: str, parameters: Mapping[str, Given], bits: int = 160) -> Proof:
    """Prove that friction holds the absorber throughout, or not; existence and uniqueness follow from the linear equations of the stuck machine."""
    motif = Motif(machine, (), (), 1, False, False)
    given = {name: decimal(value) for name, value in parameters.items()}
    with precision(bits):
        p = {name: ball(value) for name, value in given.items()}
        flights = motif.flights(p)
        size = push_amplitude(flights)
        reserves = [flights.limit[side] - side * flights.bias - size for side in (1, -1)]
        real = True if all(r > 0 for r in reserves) else False if any(r < 0 for r in reserves) else None
        # the free oscillation decays by exp(-alpha T); a shaken cavity has none
        stable = True if not flights.moving_cavity or p["damping"] > 0 else None
    proof = Proof("orbit", motif, given, box=Box([], []), real=real, stable=stable, bits=bits)
    if real is None:
        return replace(proof, obstacles=(Obstacle(Step.ADMISSIBILITY, Remedy.BORDER, 0, "stick"),))
    return replace(proof, broken=("stick", 0)) if real is False else proof


def push_amplitude(flights: Flights) -> Number:
    """Amplitude of the push on the stuck absorber, from two phases a quarter period apart."""
    quarter = ball(1).atan() * 2
    one, other = (flights.resting(phase)[0] - flights.bias for phase in (ball(0), quarter))
    return sqrt(one * one + other * other)
