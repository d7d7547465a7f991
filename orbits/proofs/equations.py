"""The equations of an orbit in proofs, block by block, with their derivatives.

A system consists of l blocks G_i(z_i, z_{i+1}, e) = 0, closed to a cycle, and border rows; e are further unknowns, as many as border rows.
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
    """The part of a word that is solved for: all of it, or half of it for a symmetric orbit.

    Attributes
    ----------
    machine : str
        A key of `orbits.proofs.flights.NAMES`.
    events : tuple of str
        Letters of the part.
    modes : tuple of int
        The mode after each event.
    periods : int
        Forcing periods of the whole orbit.
    half : bool
        Whether the part is half of a symmetric orbit; the other half is its mirror image.
    frictionless : bool
        Whether the relative velocity may change sign in flights, so that only the walls limit them.
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
        """Number of unknowns per event."""
        return 4 if self.machine in MOVING else 2

    @property
    def twist(self) -> int:
        """-1 if the part is closed by the mirror, else 1."""
        return -1 if self.half else 1

    @property
    def impact_free(self) -> bool:
        """Whether the word has no impacts."""
        return not any(letter in WALLS for letter in self.events)

    def flights(self, p: Mapping[str, Number]) -> Flights:
        """Return the machine's flights with parameters `p`."""
        return Flights(p, self.machine in MOVING)

    def arrival(self, i: int) -> tuple[str, int]:
        """Return the event that ends flight i, and the mode after it."""
        if i + 1 < len(self):
            return self.events[i + 1], self.modes[i + 1]
        letter = self.events[0]
        return (MIRRORED.get(letter, letter) if self.half else letter), self.twist * self.modes[0]

    def incoming(self, i: int) -> int:
        """Return the mode before event i."""
        return self.modes[i - 1] if i > 0 else self.twist * self.modes[-1]

    def closing(self, node: Row, p: Mapping[str, Number]) -> list[Any]:
        """Return the node at the end of the part, which is the first node a period later or its mirror image (about the middle between the walls)."""
        shift = library().arb.pi() * (self.periods if self.half else 2 * self.periods)
        found = [node[0] + shift, *(self.twist * value for value in node[1:])]
        if self.half and self.events[0] not in WALLS and "distance_left" in p:
            found[1] = found[1] + (p["distance_left"] - p["distance_right"])
        return found

    def after(self, i: int, nodes: Sequence[Row], p: Mapping[str, Number]) -> Sequence[Any]:
        """Return the node at which flight i ends."""
        return nodes[i + 1] if i + 1 < len(nodes) else self.closing(nodes[0], p)

    def residual(self, i: int, flights: Flights, x: Row, following: Row) -> list[Any]:
        """Residual of flight i; zero if the flight that begins at node `x` ends at node `following`.

        At an impact w is at the wall and B+ = v' + r w'; at a turn or stick w' = 0; at a slip the push equals the largest friction.
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
"""A border row: the block on which it depends, and a function of this block's unknowns and the further ones."""


class System:
    """A square system of equations. This class: an orbit at given parameters; derived classes add unknowns and border rows.

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
        """Return the parameters, given the further unknowns."""
        return self.p

    def prepare(self, extras: Row) -> Flights:
        """Return the flights, which all blocks share."""
        return self.motif.flights(self.numbers(extras))

    def block(self, i: int, shared: Flights, z: Row, following: Row, extras: Row) -> list[Any]:
        """Return the residuals of block i."""
        return self.motif.residual(i, shared, z, following)

    def closing(self, z: Row, extras: Row) -> list[Any]:
        """Return the unknowns after the last block, computed from those of the first."""
        return self.motif.closing(z, self.numbers(extras))

    # ------------------------------------------------------------------ evaluation
    def residuals(self, nodes: Sequence[Row], extras: Row) -> tuple[list[list[Number]], list[Number]]:
        """Return the residuals of all blocks and of the border rows."""
        shared = self.prepare(extras)
        values = []
        for i in range(self.length):
            following = nodes[i + 1] if i + 1 < self.length else self.closing(nodes[0], extras)
            values.append(self.block(i, shared, nodes[i], following, extras))
        return values, [row(nodes[i], extras) for i, row in self.borders]

    def linearise(self, nodes: Sequence[Row], extras: Row) -> Blocks:
        """Return enclosures of all derivatives over a box, with right sides zero."""
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
    """A parameter that varies, and the machine's numbers that depend on it as ``factor * parameter**exponent``.

    Attributes
    ----------
    name : str
        Name of the parameter; for a machine in physical units a quantity in its unit.
    numbers : dict of str to (str, int or float)
        Name of the machine's number -> (factor as an exact decimal, exponent).
    """

    name: str
    numbers: Mapping[str, tuple[str, int | float]]

    @overload
    def at(self, value: arb) -> dict[str, arb]: ...
    @overload
    def at(self, value: Jet) -> dict[str, Jet]: ...
    def at(self, value: Number) -> Mapping[str, Number]:
        """Return the numbers that depend on the parameter, at one value of it (a ball or a jet)."""
        return {
            number: power(value, exponent) if factor == "1" else ball(factor) * power(value, exponent)
            for number, (factor, exponent) in self.numbers.items()
        }
