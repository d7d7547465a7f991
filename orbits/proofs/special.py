"""Special points as zeros of their defining systems.

Fold, symmetry breaking, period doubling (multiplier mu = 1 or -1 of the period's map, or of half of it followed by the mirror):

    G_i(x_i, x_{i+1}, p) = 0,    dG_i (phi_i, phi_{i+1}) = 0,    phi_l = mu phi_0,    one component of phi = 1;

Neimark-Sacker: the same with a complex phi and mu = exp(i theta); borders: the margin that vanishes, with the phase at which it does
as a further unknown where it is a minimum inside a flight.

**A regular zero is transversal.** If the whole derivative is regular at the zero (which the interval Newton operator proves), then
for a fold the curve of orbits has a quadratic turning point there (Moore and Spence, *SIAM J. Numer. Anal.* 17, 1980); for mu = -1 and
for the pair, orbits go on smoothly in p and d mu/dp, or d|mu|/dp, is not 0: the multiplier crosses the circle; for a border, the
curve of orbits is smooth there and the margin changes sign along it. `docs/proofs.md` has the short arguments.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from orbits.proofs.equations import Motif, System
from orbits.proofs.jets import Jet, partial, sin_cos
from orbits.proofs.varying import Varying

if TYPE_CHECKING:
    from flint import arb

    from orbits.proofs.flights import Flights
    from orbits.proofs.jets import Number, Row


@dataclass(frozen=True)
class Normal:
    """The component of phi that is 1: of which node, and which of its unknowns."""

    block: int
    component: int


class Family(NamedTuple):
    """All orbits of a motif along the parameter that varies; `p` are the numbers that do not move with it."""

    motif: Motif
    p: Mapping[str, arb]
    varying: Varying

    def numbers(self, value: arb) -> dict[str, arb]:
        """All numbers of the machine at a value of the parameter."""
        return {**self.p, **self.varying.at(value)}

    def system(self, value: arb) -> System:
        """The orbit at a value of the parameter."""
        return System(self.motif, self.numbers(value))


class AtParameter(System):
    """Base of the systems in which the parameter that varies is an unknown, the first of the further ones."""

    def __init__(self, family: Family) -> None:
        super().__init__(family.motif, family.p)
        self.varying, self.m = family.varying, 1

    def numbers(self, extras: Row) -> Mapping[str, Number]:
        """The parameters, at the unknown one."""
        return self.p | self.varying.at(extras[0])


class AtMultiplier(AtParameter):
    """Orbits with a multiplier `mu`, 1 or -1; unknowns (x_i, phi_i) per node."""

    directions = 1

    def __init__(self, family: Family, mu: int, normal: Normal) -> None:
        super().__init__(family)
        self.mu, self.normal = mu, normal
        self.n = self.motif.node
        self.k = self.n * (1 + self.directions)
        place = self.n + normal.component
        self.borders = ((normal.block, lambda z, e: z[place] - 1),)

    def prepare(self, extras: Row) -> Flights:
        """The flights over numbers with one direction; what does not move along it is lifted."""
        lifted = {name: Jet(value, {}) for name, value in self.p.items()}
        return self.motif.flights(lifted | self.varying.at(Jet(extras[0], {})))

    def block(self, i: int, shared: Flights, z: Row, following: Row, extras: Row) -> list[Any]:
        """The map, then its derivative along each direction."""
        rows = self.motif.residual(i, shared, self._along(z), self._along(following))
        return [row.value for row in rows] + [partial(row, d) for d in range(self.directions) for row in rows]

    def _along(self, z: Row) -> list[Jet]:
        n = self.n
        return [Jet(z[j], {d: z[n * (1 + d) + j] for d in range(self.directions)}) for j in range(n)]

    def closing(self, z: Row, extras: Row) -> list[Any]:
        """x_l and phi_l = mu phi_0, seen through the mirror on half a word."""
        n = self.n
        return self.motif.closing(z[:n], self.numbers(extras)) + self._mirrored(
            [self.mu * value for value in z[n:]]
        )

    def _mirrored(self, phi: list[Number]) -> list[Number]:
        return [phi[0], *(self.motif.twist * value for value in phi[1:])]


class AtPair(AtMultiplier):
    """Orbits with the multipliers exp(+-i theta); unknowns (x_i, Re phi_i, Im phi_i), further ones p and theta."""

    directions = 2

    def __init__(self, family: Family, normal: Normal) -> None:
        super().__init__(family, 1, normal)
        self.m = 2
        imaginary = 2 * self.n + normal.component
        self.borders = (*self.borders, (normal.block, lambda z, e: z[imaginary]))

    def closing(self, z: Row, extras: Row) -> list[Any]:
        """x_l and phi_l = exp(i theta) phi_0."""
        n = self.n
        s, c = sin_cos(extras[1])
        a, b = z[n : 2 * n], z[2 * n :]
        real = [c * p - s * q for p, q in zip(a, b)]
        imaginary = [s * p + c * q for p, q in zip(a, b)]
        return (
            self.motif.closing(z[:n], self.numbers(extras)) + self._mirrored(real) + self._mirrored(imaginary)
        )


@dataclass(frozen=True)
class Vanishing:
    """The margin that vanishes at a border: its name, the event, and on which side.

    Names are those of `orbits.words.margins` and "reversal" (a wall met by a flight that reverses freely).
    """

    name: str
    event: int
    side: int = 1

    @property
    def kind(self) -> str:
        """Kind of the border."""
        grazes = {
            "flight": "velocity-graze",
            "wall": "wall-graze",
            "reversal": "wall-graze",
            "approach": "wall-graze",
        }
        return grazes.get(self.name, "stick")

    @property
    def inside(self) -> bool:
        """Whether it vanishes at an unknown phase inside the flight after the event."""
        return self.name in ("flight", "hold", "reversal")


class AtBorder(AtParameter):
    """Orbits at a border; further unknowns p and, for a margin inside a flight, the phase at which it vanishes."""

    def __init__(self, family: Family, vanishing: Vanishing) -> None:
        super().__init__(family)
        self.vanishing = vanishing
        i = vanishing.event
        if vanishing.inside:
            self.m = 2
            self.borders = ((i, self._row(0)), (i, self._row(1)))
        else:
            self.borders = ((i, self._row(0)),)

    def _row(self, which: int) -> Callable[[Row, Row], Any]:
        def row(x: Row, extras: Row) -> Number | None:
            return self._margin(x, extras)[which]

        return row

    def _margin(self, x: Row, extras: Row) -> tuple[Number, Number | None]:
        """The margin's equation, and that of the phase where it vanishes."""
        motif, v = self.motif, self.vanishing
        flights = self.prepare(extras)
        flight = flights.launch(motif.events[v.event], motif.modes[v.event], x)
        if v.inside:
            m = flight(extras[1])
            if v.name == "flight":
                return m.w1, m.w2
            if v.name == "hold":
                return flights.limit[v.side] - v.side * m.push, m.push1
            return flights.room[v.side] - v.side * m.w, m.w1
        m = flight(x[0])
        if v.name == "approach":
            return m.w1, None
        if v.name in ("turn", "stick"):
            return flights.limit[v.side] - v.side * m.push, None
        if v.name == "slip":
            return m.push1, None
        return flights.room[v.side] - v.side * x[1], None
