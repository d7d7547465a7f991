"""Numbers near a special point for Newton's method: eigenvectors along the orbit, the phase at which a margin vanishes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from orbits.proofs.balls import diagonal, library
from orbits.proofs.equations import Motif, System
from orbits.proofs.flights import Flight, Flights
from orbits.proofs.obstacles import Obstacle, Remedy, Step
from orbits.proofs.special import Normal, Vanishing
from orbits.proofs.stability import linear_maps, middle_product

if TYPE_CHECKING:
    from flint import arb, arb_mat

    from orbits.proofs.elimination import Nodes

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
