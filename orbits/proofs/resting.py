"""The stuck absorber: it rides with the cavity, and all that has to be proved is that friction holds.

The push against friction is a harmonic of the forcing about the bias, so it is largest in closed form.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from orbits.proofs.balls import Given, ball, decimal, precision
from orbits.proofs.enclosing import Box
from orbits.proofs.equations import Motif
from orbits.proofs.jets import sqrt
from orbits.proofs.obstacles import Obstacle, Remedy, Step
from orbits.proofs.proof import Proof
from orbits.proofs.special import AtParameter, Family

if TYPE_CHECKING:
    from orbits.proofs.flights import Flights
    from orbits.proofs.jets import Number, Row


class AtSlip(AtParameter):
    """Where friction just holds the stuck absorber; unknowns the phase at which the push is largest, and the parameter."""

    def __init__(self, family: Family, side: int) -> None:
        super().__init__(family)
        self.k = self.length = 1

        def row(z: Row, extras: Row) -> Number:
            flights = self.prepare(extras)
            return flights.limit[side] - side * flights.resting(z[0])[0]

        self.borders = ((0, row),)

    def block(self, i: int, shared: Flights, z: Row, following: Row, extras: Row) -> list[Any]:
        """The push is at its extremum."""
        return [shared.resting(z[0])[1]]

    def closing(self, z: Row, extras: Row) -> list[Any]:
        """There is no map to close."""
        return list(z)


def prove_stuck(machine: str, parameters: Mapping[str, Given], bits: int = 160) -> Proof:
    """Whether the absorber can stay stuck; the motion itself exists in closed form, alone in its linear equations."""
    motif = Motif(machine, (), (), 1, False, False)
    given = {name: decimal(value) for name, value in parameters.items()}
    with precision(bits):
        p = {name: ball(value) for name, value in given.items()}
        flights = motif.flights(p)
        size = push_amplitude(flights)
        reserves = [flights.limit[side] - side * flights.bias - size for side in (1, -1)]
        real = True if all(r > 0 for r in reserves) else False if any(r < 0 for r in reserves) else None
        # the oscillator's free motion decays by exp(-alpha T); the shaken cavity has none
        stable = True if not flights.moving_cavity or p["damping"] > 0 else None
    proof = Proof("orbit", motif, given, box=Box([], []), real=real, stable=stable, bits=bits)
    if real is None:
        return replace(proof, obstacles=(Obstacle(Step.ADMISSIBILITY, Remedy.BORDER, 0, "stick"),))
    return replace(proof, broken=("stick", 0)) if real is False else proof


def push_amplitude(flights: Flights) -> Number:
    """Amplitude of the push on the stuck absorber, from two phases a quarter apart."""
    quarter = ball(1).atan() * 2
    one, other = (flights.resting(phase)[0] - flights.bias for phase in (ball(0), quarter))
    return sqrt(one * one + other * other)
