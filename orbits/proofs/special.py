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

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from orbits.proofs.balls import diagonal, library
from orbits.proofs.equations import Motif, System, Varying
from orbits.proofs.flights import Flight, Flights
from orbits.proofs.jets import Jet, partial, sin_cos
from orbits.proofs.obstacles import Obstacle, Remedy, Step
from orbits.proofs.stability import linear_maps, middle_product

if TYPE_CHECKING:
    from flint import arb, arb_mat

    from orbits.proofs.elimination import Nodes
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

    Names are those of `orbits.words` and "reversal" (a wall met by a flight that reverses freely).
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


SAMPLES = 400


def chain(motif: Motif, p: Mapping[str, arb], nodes: Nodes) -> list[arb_mat]:
    """The linearised maps at the middles, each a matrix of exact numbers."""
    try:
        return [factor.mid() for factor in linear_maps(System(motif, p), nodes)]
    except ZeroDivisionError:
        raise Obstacle(Step.REFINEMENT, Remedy.DEGENERATE) from None


def eigenvector(factors: Sequence[arb_mat], mu: int) -> tuple[list[list[arb]], Normal]:
    """phi at every node for the real multiplier nearest to mu, its largest component 1, and where that is."""
    arb, arb_mat = library().arb, library().arb_mat
    size = factors[0].nrows()
    product = middle_product(factors)
    shifted = product - diagonal(size, arb(mu))
    # inverse iteration; the multiplier is known to about ten digits only
    tilt = arb(2) ** (-60)
    shifted = shifted + diagonal(size, tilt)
    vector = arb_mat(size, 1, [arb(1) / (1 + i) for i in range(size)])
    for _ in range(3):
        try:
            vector = shifted.mid().solve(vector).mid()
        except ZeroDivisionError:
            raise Obstacle(Step.REFINEMENT, Remedy.DEGENERATE) from None
        largest = max((vector[i, 0] for i in range(size)), key=lambda v: float(abs(v)))
        vector = (vector * (1 / largest)).mid()
    return _scaled(_carried(factors, vector))


def eigenpair(factors: Sequence[arb_mat]) -> tuple[list[list[arb]], Normal, float]:
    """Re phi and Im phi at every node for the complex multiplier nearest to the unit circle, and its angle."""
    numbers = np.array([[float(value) for value in row] for row in middle_product(factors).tolist()])
    values, vectors = np.linalg.eig(numbers)
    upper = [j for j, value in enumerate(values) if value.imag > 0.0]
    if not upper:
        raise Obstacle(Step.REFINEMENT, Remedy.DEGENERATE, detail="no complex pair of multipliers")
    best = min(upper, key=lambda j: abs(abs(values[j]) - 1.0))
    vector = vectors[:, best] / vectors[np.argmax(np.abs(vectors[:, best])), best]
    arb, arb_mat = library().arb, library().arb_mat
    real = _carried(factors, arb_mat([[arb(float(v.real))] for v in vector]))
    imaginary = _carried(factors, arb_mat([[arb(float(v.imag))] for v in vector]))
    normal = Normal(0, int(np.argmax(np.abs(vector))))
    return [a + b for a, b in zip(real, imaginary)], normal, float(np.angle(values[best]))


def vanishing_margin(motif: Motif, p: Mapping[str, arb], nodes: Nodes, name: str, event: int) -> Vanishing:
    """The margin of this name, with the side on which it vanishes (of the two walls, or of the push's two directions)."""
    flights = motif.flights(p)
    flight = flights.launch(motif.events[event], motif.modes[event], nodes[event])
    side = 1
    if name == "duration":
        raise Obstacle(Step.EXISTENCE, Remedy.OTHER_WORD, event, "a flight of no duration")
    if name in ("hold", "reversal"):
        both = [Vanishing(name, event, side) for side in (1, -1)]
        least = [_least(motif, p, nodes, vanishing) for vanishing in both]
        found = [(pair[0], vanishing) for pair, vanishing in zip(least, both) if pair is not None]
        return min(found, key=lambda pair: pair[0])[1] if found else both[0]
    if name in ("turn", "stick"):
        side = 1 if flight(nodes[event][0]).push > 0 else -1
    elif name == "wall":
        side = 1 if nodes[event][1] > 0 else -1
    return Vanishing(name, event, side)


def touching_phase(motif: Motif, p: Mapping[str, arb], nodes: Nodes, vanishing: Vanishing) -> arb:
    """The phase inside the flight at which the margin is smallest, roughly."""
    least = _least(motif, p, nodes, vanishing)
    if least is None:
        raise Obstacle(
            Step.REFINEMENT, Remedy.START, vanishing.event, "the margin has no minimum inside this flight"
        )
    return least[1]


def _least(
    motif: Motif, p: Mapping[str, arb], nodes: Nodes, vanishing: Vanishing
) -> tuple[float, arb] | None:
    """The smallest value of a margin at a minimum inside its flight, and where."""
    i = vanishing.event
    flights = motif.flights(p)
    flight = flights.launch(motif.events[i], motif.modes[i], nodes[i])
    first, last = nodes[i][0].mid(), motif.after(i, nodes, p)[0].mid()
    candidates = []
    for j in range(1, SAMPLES):
        phase = (first + (last - first) * j / SAMPLES).mid()
        candidates.append((_size(flight, phase, motif.modes[i], vanishing, flights), phase))
    inner = [
        candidates[j]
        for j in range(1, len(candidates) - 1)
        if candidates[j - 1][0] >= candidates[j][0] <= candidates[j + 1][0]
    ]
    return min(inner, key=lambda pair: pair[0]) if inner else None


def _size(flight: Flight, phase: arb, mode: int, vanishing: Vanishing, machine: Flights) -> float:
    m = flight(phase)
    if vanishing.name == "flight":
        return float((mode * m.w1).mid())
    if vanishing.name == "hold":
        return float((machine.limit[vanishing.side] - vanishing.side * m.push).mid())
    return float((machine.room[vanishing.side] - vanishing.side * m.w).mid())


def _carried(factors: Sequence[arb_mat], vector: arb_mat) -> list[list[arb]]:
    result = []
    for factor in factors:
        result.append([vector[i, 0] for i in range(vector.nrows())])
        vector = (factor * vector).mid()
    return result


def _scaled(phi: list[list[arb]]) -> tuple[list[list[arb]], Normal]:
    """The vectors with their largest component made 1."""
    places = [(i, j) for i in range(len(phi)) for j in range(len(phi[i]))]
    i, j = max(places, key=lambda place: float(abs(phi[place[0]][place[1]])))
    scale = phi[i][j]
    return [[(value / scale).mid() for value in vector] for vector in phi], Normal(i, j)
