"""The equations of an orbit as the proofs solve them, block by block, with their derivatives.

A system is l equations blocks G_i(z_i, z_{i+1}, e) = 0 closed to a cycle, e being further unknowns, and as many border rows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

from orbits.proofs.balls import ball, library
from orbits.proofs.elimination import Blocks
from orbits.proofs.flights import MOVING, WALLS, Flights, wall
from orbits.proofs.jets import partial, power, variables

if TYPE_CHECKING:
    from flint import arb

    from orbits.proofs.jets import Jet, Number, Row


MIRRORED = {"L": "R", "R": "L"}


@dataclass(frozen=True)
class Motif:
    """What is solved for: a word, over its whole period or over half of it for a symmetric orbit.

    Attributes
    ----------
    machine : str
        A key of `orbits.proofs.flights.NAMES`.
    events : tuple of str
        Letters of the part that is solved for.
    modes : tuple of int
        The mode after each of them.
    periods : int
        Forcing periods of the whole orbit.
    half : bool
        The part is half of a symmetric orbit, which its mirror image completes.
    frictionless : bool
        Flights may reverse freely, and only the walls limit them.
    """

    machine: str
    events: tuple[str, ...]
    modes: tuple[int, ...]
    periods: int
    half: bool
    frictionless: bool

    def __len__(self) -> int:
        return len(self.events)

    @property
    def node(self) -> int:
        """Unknowns per event."""
        return 4 if self.machine in MOVING else 2

    @property
    def twist(self) -> int:
        """-1 where the mirror closes the part."""
        return -1 if self.half else 1

    @property
    def impact_free(self) -> bool:
        """Whether no wall is hit."""
        return not any(letter in WALLS for letter in self.events)

    def flights(self, p: Mapping[str, Number]) -> Flights:
        """The machine's flights with parameters `p`."""
        return Flights(p, self.machine in MOVING)

    def arrival(self, i: int) -> tuple[str, int]:
        """The event that ends flight i, and the mode after it."""
        if i + 1 < len(self):
            return self.events[i + 1], self.modes[i + 1]
        letter = self.events[0]
        return (MIRRORED.get(letter, letter) if self.half else letter), self.twist * self.modes[0]

    def incoming(self, i: int) -> int:
        """The mode before event i."""
        return self.modes[i - 1] if i > 0 else self.twist * self.modes[-1]

    def closing(self, node: Row, p: Mapping[str, Number]) -> list[Any]:
        """The first node again, at the end of the part; a position is mirrored about the middle between the walls."""
        shift = library().arb.pi() * (self.periods if self.half else 2 * self.periods)
        found = [node[0] + shift, *(self.twist * value for value in node[1:])]
        if self.half and self.events[0] not in WALLS and "distance_left" in p:
            found[1] = found[1] + (p["distance_left"] - p["distance_right"])
        return found

    def after(self, i: int, nodes: Sequence[Row], p: Mapping[str, Number]) -> Sequence[Any]:
        """The node at which flight i ends."""
        return nodes[i + 1] if i + 1 < len(nodes) else self.closing(nodes[0], p)

    def residual(self, i: int, flights: Flights, x: Row, following: Row) -> list[Any]:
        """The elementary map of flight i, zero where `following` is the node that `x` leads to.

        At an impact w is at the wall and B+ = v' + r w'; at a turn or stick w' = 0; at a slip the push reaches friction.
        """
        end = flights.launch(self.events[i], self.modes[i], x)(following[0])
        letter, mode = self.arrival(i)
        if letter in WALLS:
            r = flights.restitution(letter)
            rows = [end.w - wall(flights, letter), end.v1 + r * end.w1 - following[1]]
        elif letter == "u":
            rows = [end.push - mode * flights.limit[mode], end.w - following[1]]
        else:
            rows = [end.w1, end.w - following[1]]
        if flights.moving_cavity:
            rows += [end.v - following[2], end.v1 - following[3]]
        return rows


Border = tuple[int, "Callable[[Row, Row], Number]"]
"""A border row: the block it reads, and its value from that block's unknowns and the further ones."""


class System:
    """A square system; this one is the orbit itself at definite parameters.

    Parameters
    ----------
    motif : Motif
    p : dict of str to arb
        Parameters.
    """

    def __init__(self, motif: Motif, p: Mapping[str, arb]) -> None:
        self.motif, self.p = motif, dict(p)
        self.k, self.m, self.length = motif.node, 0, len(motif)
        self.borders: tuple[Border, ...] = ()

    def numbers(self, extras: Row) -> Mapping[str, Number]:
        """The parameters, at these further unknowns."""
        return self.p

    def prepare(self, extras: Row) -> Flights:
        """What all blocks share."""
        return self.motif.flights(self.numbers(extras))

    def block(self, i: int, shared: Flights, z: Row, following: Row, extras: Row) -> list[Any]:
        """Residuals of block i."""
        return self.motif.residual(i, shared, z, following)

    def closing(self, z: Row, extras: Row) -> list[Any]:
        """The unknowns that follow the last block, from those of the first."""
        return self.motif.closing(z, self.numbers(extras))

    # ------------------------------------------------------------------ evaluation
    def residuals(self, nodes: Sequence[Row], extras: Row) -> tuple[list[list[Number]], list[Number]]:
        """Values of all equations."""
        shared = self.prepare(extras)
        values = []
        for i in range(self.length):
            following = nodes[i + 1] if i + 1 < self.length else self.closing(nodes[0], extras)
            values.append(self.block(i, shared, nodes[i], following, extras))
        return values, [row(nodes[i], extras) for i, row in self.borders]

    def linearise(self, nodes: Sequence[Row], extras: Row) -> Blocks:
        """All derivatives over a box; right sides are zero."""
        k, m = self.k, self.m
        e = variables(extras, 2 * k)
        shared = self.prepare(e)
        system = Blocks([], [], [], [], [], [], [])
        for i in range(self.length):
            z = variables(nodes[i])
            if i + 1 < self.length:
                following = variables(nodes[i + 1], k)
            else:
                following = self.closing(variables(nodes[0], k), e)
            rows = self.block(i, shared, z, following, e)
            system.A.append([[partial(row, j) for j in range(k)] for row in rows])
            system.D.append([[partial(row, k + j) for j in range(k)] for row in rows])
            system.E.append([[partial(row, 2 * k + j) for j in range(m)] for row in rows])
            system.b.append([0] * k)
        for i, row in self.borders:
            value = row(variables(nodes[i]), e)
            system.rows.append({i: [partial(value, j) for j in range(k)]})
            system.corner.append([partial(value, 2 * k + j) for j in range(m)])
            system.c.append(0)
        return system


@dataclass(frozen=True)
class Varying:
    """A parameter, and what follows it: number j is ``factor * parameter**exponent``.

    Attributes
    ----------
    name : str
        As people call it; for a machine in physical units a quantity, counted in its unit.
    numbers : dict of str to (str, int or float)
        By the machine's number: the factor, an exact decimal, and the exponent.
    """

    name: str
    numbers: Mapping[str, tuple[str, int | float]]

    @overload
    def at(self, value: arb) -> dict[str, arb]: ...
    @overload
    def at(self, value: Jet) -> dict[str, Jet]: ...
    def at(self, value: Number) -> Mapping[str, Number]:
        """The numbers that move, at a value of the parameter (a ball or a jet)."""
        return {
            number: power(value, exponent) if factor == "1" else ball(factor) * power(value, exponent)
            for number, (factor, exponent) in self.numbers.items()
        }
