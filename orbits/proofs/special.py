"""Defining systems of special points.

Fold, symmetry breaking, period doubling (multiplier mu = 1 or -1 of the map over the period, or over half of it followed by the mirror):

    G_i(x_i, x_{i+1}, p) = 0,    dG_i (phi_i, phi_{i+1}) = 0,    phi_l = mu phi_0,    one component of phi = 1;

Neimark-Sacker point: the same with a complex phi and mu = exp(i theta). Border: the margin vanishes; if it vanishes as a minimum inside a flight,
the phase of this minimum is a further unknown.

**A regular zero is transversal.** If the whole derivative is regular at the zero (which the interval Newton operator proves), then

- at a fold the curve of orbits has a quadratic turning point (Moore and Spence, *SIAM J. Numer. Anal.* 17, 1980);
- for mu = -1 and for a pair, orbits depend smoothly on p, and d mu/dp, or d|mu|/dp, is not 0: the multiplier crosses the unit circle;
- at a border the curve of orbits is smooth and the margin changes sign along it.

`docs/proofs.md` has the short arguments.
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
    """The component of the eigenvector phi that is normalised to 1: node and component."""

    block: int
    component: int


class Family(NamedTuple):
    """All orbits of a motif as a parameter varies; `p` has the machine's numbers that do not depend on it."""

    motif: Motif
    p: Mapping[str, arb]
    varying: Varying

    def numbers(self, value: arb) -> dict[str, arb]:
        """Return all numbers of the machine at a value of the parameter."""
        return {**self.p, **self.varying.at(value)}

    def system(self, value: arb) -> System:
        """Return the system of the orbit at a value of the parameter."""
        return System(self.motif, self.numbers(value))


class AtParameter(System):
    """Base class of systems in which the varying parameter is an unknown, the first of the further ones."""

    def __init__(self, family: Family) -> None:
        super().__init__(family.motif, family.p)
        self.varying, self.m = family.varying, 1

    def numbers(self, extras: Row) -> Mapping[str, Number]:
        """Return the machine's numbers at the unknown parameter."""
        return self.p | self.varying.at(extras[0])


class AtMultiplier(AtParameter):
    """Defining system of orbits with a multiplier `mu` = 1 or -1; unknowns (x_i, phi_i) per node."""

    directions = 1

    def __init__(self, family: Family, mu: int, normal: Normal) -> None:
        super().__init__(family)
        self.mu, self.normal = mu, normal
        self.n = self.motif.node
        self.k = self.n * (1 + self.directions)
        place = self.n + normal.component
        self.borders = ((normal.block, lambda z, e: z[place] - 1),)

    def prepare(self, extras: Row) -> Flights:
        """Return the flights over jets in the eigenvector's direction; constants become jets without derivatives."""
        lifted = {name: Jet(value, {}) for name, value in self.p.items()}
        return self.motif.flights(lifted | self.varying.at(Jet(extras[0], {})))

    def block(self, i: int, shared: Flights, z: Row, following: Row, extras: Row) -> list[Any]:
        """Return the residuals of the map, then their derivatives along each direction."""
        rows = self.motif.residual(i, shared, self._along(z), self._along(following))
        return [row.value for row in rows] + [partial(row, d) for d in range(self.directions) for row in rows]

    def _along(self, z: Row) -> list[Jet]:
        n = self.n
        return [Jet(z[j], {d: z[n * (1 + d) + j] for d in range(self.directions)}) for j in range(n)]

    def closing(self, z: Row, extras: Row) -> list[Any]:
        """Return x_l and phi_l = mu phi_0, mirrored if half a word is solved for."""
        n = self.n
        return self.motif.closing(z[:n], self.numbers(extras)) + self._mirrored(
            [self.mu * value for value in z[n:]]
        )

    def _mirrored(self, phi: list[Number]) -> list[Number]:
        return [phi[0], *(self.motif.twist * value for value in phi[1:])]


class AtPair(AtMultiplier):
    """Defining system of orbits with multipliers exp(+-i theta); unknowns (x_i, Re phi_i, Im phi_i) per node, further unknowns p and theta."""

    directions = 2

    def __init__(self, family: Family, normal: Normal) -> None:
        super().__init__(family, 1, normal)
        self.m = 2
        imaginary = 2 * self.n + normal.component
        self.borders = (*self.borders, (normal.block, lambda z, e: z[imaginary]))

    def closing(self, z: Row, extras: Row) -> list[Any]:
        """Return x_l and phi_l = exp(i theta) phi_0."""
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
    """The margin that vanishes at a border: its name, event and side.

    Names are those of `orbits.words`, and "reversal" (a flight without friction touches a wall).
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
    """Defining system of orbits at a border; further unknowns are p and, for a margin inside a flight, the phase at which it vanishes."""

    def __init__(self, family: Family, vanishing: Vanishing) -> None:
        super().__init__(family)
        self.vanishing = vanishing
        i = vanishing.event
        if vanishing.inside:
            self.m = 2
            self.borders = ((i, self._row(0)), (i, self._row(1)))
        else:
            self.borders = ((i, self._row(0)),)

    def _row(self, index: int) -> Callable[[Row, Row], Any]:
        def row(x: Row, extras: Row) -> Number | None:
            return self._margin(x, extras)[index]

        return row

    def _margin(self, x: Row, extras: Row) -> tuple[Number, Number | None]:
        """Return the margin, and the equation for the phase at which it vanishes (None for a margin at an event)."""
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


SAMPLES = 400  # phases of a flight at which a minimum of a margin is sought


def chain(motif: Motif, p: Mapping[str, arb], nodes: Nodes) -> list[arb_mat]:
    """Return the middles of the linearised maps."""
    try:
        return [factor.mid() for factor in linear_maps(System(motif, p), nodes)]
    except ZeroDivisionError:
        raise Obstacle(Step.REFINEMENT, Remedy.DEGENERATE) from None


def eigenvector(factors: Sequence[arb_mat], mu: int) -> tuple[list[list[arb]], Normal]:
    """Compute the eigenvector phi at every node for the real multiplier nearest to mu, with largest component 1; return it and this component's place."""
    arb, arb_mat = library().arb, library().arb_mat
    size = factors[0].nrows()
    product = middle_product(factors)
    shifted = product - diagonal(size, arb(mu))
    # inverse iteration with a small shift, because the multiplier equals mu to about ten digits only
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
    """Compute Re phi and Im phi at every node for the complex multiplier nearest to the unit circle; return them, the normalised component and the angle."""
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
    """Return the margin of this name with its side: the wall, or the direction of the push, for which it vanishes."""
    flights = motif.flights(p)
    flight = flights.launch(motif.events[event], motif.modes[event], nodes[event])
    side = 1
    if name == "duration":
        raise Obstacle(Step.EXISTENCE, Remedy.OTHER_WORD, event, "a flight of no duration")
    if name in ("hold", "reversal"):
        candidates = [Vanishing(name, event, side) for side in (1, -1)]
        least = [_lowest_minimum(motif, p, nodes, vanishing) for vanishing in candidates]
        found = [(pair[0], vanishing) for pair, vanishing in zip(least, candidates) if pair is not None]
        return min(found, key=lambda pair: pair[0])[1] if found else candidates[0]
    if name in ("turn", "stick"):
        side = 1 if flight(nodes[event][0]).push > 0 else -1
    elif name == "wall":
        side = 1 if nodes[event][1] > 0 else -1
    return Vanishing(name, event, side)


def touching_phase(motif: Motif, p: Mapping[str, arb], nodes: Nodes, vanishing: Vanishing) -> arb:
    """Return the approximate phase of the margin's minimum inside its flight."""
    least = _lowest_minimum(motif, p, nodes, vanishing)
    if least is None:
        raise Obstacle(
            Step.REFINEMENT, Remedy.START, vanishing.event, "the margin has no minimum inside this flight"
        )
    return least[1]


def _lowest_minimum(
    motif: Motif, p: Mapping[str, arb], nodes: Nodes, vanishing: Vanishing
) -> tuple[float, arb] | None:
    """Return value and phase of a margin's lowest minimum inside its flight; None without a minimum."""
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
    """Return the margin at a phase of the flight."""
    m = flight(phase)
    if vanishing.name == "flight":
        return float((mode * m.w1).mid())
    if vanishing.name == "hold":
        return float((machine.limit[vanishing.side] - vanishing.side * m.push).mid())
    return float((machine.room[vanishing.side] - vanishing.side * m.w).mid())


def _carried(factors: Sequence[arb_mat], vector: arb_mat) -> list[list[arb]]:
    """Map a vector at the first node to all nodes by the linearised maps."""
    result = []
    for factor in factors:
        result.append([vector[i, 0] for i in range(vector.nrows())])
        vector = (factor * vector).mid()
    return result


def _scaled(phi: list[list[arb]]) -> tuple[list[list[arb]], Normal]:
    """Scale the vectors so that their largest component is 1; return them and its place."""
    places = [(i, j) for i in range(len(phi)) for j in range(len(phi[i]))]
    i, j = max(places, key=lambda place: float(abs(phi[place[0]][place[1]])))
    scale = phi[i][j]
    return [[(value / scale).mid() for value in vector] for vector in phi], Normal(i, j)
