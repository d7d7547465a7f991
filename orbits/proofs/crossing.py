"""What happens at a special point, shown by two orbits on both sides of it and a tile that joins them.

The defining system (`orbits.proofs.special`) encloses the point to thirty digits. Its certificate says the same so that less mathematics is
needed to check it: one orbit where the multiplier or the margin has one sign, one where it has the other, both on one curve.
"""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal, localcontext
from typing import TYPE_CHECKING

from orbits.proofs.balls import ball, texts
from orbits.proofs.certificates import Entry, orbit_box, resting_box, tile_box
from orbits.proofs.enclosing import Box, enclose, refine
from orbits.proofs.obstacles import Obstacle, Remedy, Step
from orbits.proofs.special import Family, Normal
from orbits.proofs.stability import away_from_one, basis_texts
from orbits.proofs.tiles import DIGITS, Along, lay

if TYPE_CHECKING:
    from flint import arb

    from orbits.proofs.elimination import Nodes

APART = ("2e-11", "2e-14", "2e-17", "2e-20", "2e-26", "2e-32", "2e-38")
"""Of either orbit from the special point; nearer where the branch bends sharply or a long word's map is known too roughly in the tile."""
TURN = (
    "1e-6",
    "1e-8",
    "1e-10",
    "1e-13",
    "1e-19",
    "1e-25",
    "1e-31",
)  # the same in the unknown that goes on where the parameter turns
WIDTH = 1.25  # of the tile


def crossing(
    family: Family,
    z: Nodes,
    value: arb,
    bits: int,
    turn: Normal | None = None,
    pair: bool = False,
) -> list[Entry]:
    """The chain orbit, tile, orbit about a special point.

    Parameters
    ----------
    z, value : the point's nodes (with an eigenvector where there is one), and the parameter there.
    turn : Normal, optional
        At a fold the unknown along which the branch goes on.
    pair : bool
        A pair of multipliers crosses the circle: no multiplier is 1 or -1 in the tile.

    Raises
    ------
    Obstacle
        If one of the three is not proved, or the orbits do not lie in the tile.
    """
    motif = family.motif
    if not len(motif):
        center, half = texts(value.mid(), DIGITS)[0], f"{float(APART[0]) * WIDTH:.3g}"
        low, high = (_shifted(center, sign, APART[0]) for sign in (-1, 1))
        return [resting_box(motif, low), resting_box(motif, center, half), resting_box(motif, high)]
    for apart in APART if turn is None else TURN:
        try:
            return _chain(family, z, value, bits, turn, apart, pair)
        except Obstacle as obstacle:
            if apart in (APART[-1], TURN[-1]):
                raise obstacle from None
    raise AssertionError("no distance to try")


def _chain(
    family: Family,
    z: Nodes,
    value: arb,
    bits: int,
    turn: Normal | None,
    apart: str,
    pair: bool,
) -> list[Entry]:
    """`crossing` with orbits this far from the point."""
    n = family.motif.node
    nodes = [list(node[:n]) for node in z]
    center = texts(value.mid(), DIGITS)[0]
    if turn is None:
        ends = [_shifted(center, sign, apart) for sign in (-1, 1)]
        along, starts = Along(family, None, ball(center)), [nodes, nodes]
    else:
        place = turn.block, turn.component
        center = texts(nodes[place[0]][place[1]].mid(), DIGITS)[0]
        along = Along(family, place, ball(_shifted(center, 1, apart)))
        starts = [
            [[a + b * ball(apart) * sign for a, b in zip(node[:n], node[n:])] for node in z]
            for sign in (-1, 1)
        ]
        _, (there,) = refine(along, starts[1], [value], bits)
        ends = [texts(there.mid(), DIGITS)[0]] * 2
        along.at = ball(center)
    tile = lay(along, center, f"{float(apart) * WIDTH:.3g}", nodes, value)
    if tile is None:
        raise Obstacle(Step.EXISTENCE, Remedy.BITS, detail="the branch about the point")
    if pair and not away_from_one(family.system(tile.values()), tile.balls()):
        raise Obstacle(Step.EXISTENCE, Remedy.BITS, detail="the multipliers about the point")
    boxes = [orbit_at(family, end, start, bits) for end, start in zip(ends, starts)]
    if not all(tile.holds(end, box) for end, box in zip(ends, boxes)):
        raise Obstacle(Step.EXISTENCE, Remedy.BITS, detail="the branch about the point")
    one, other = (orbit_entry(family, end, box) for end, box in zip(ends, boxes))
    with_basis = replace(tile, basis=basis_texts(family.system(tile.values()), tile.balls()))
    return [one, tile_box(family.motif, with_basis), other]


def orbit_at(family: Family, value: str, start: Nodes, bits: int) -> Box:
    """The orbit near `start` at a value of the parameter.

    Raises
    ------
    Obstacle
    """
    system = family.system(ball(value))
    z, _ = refine(system, start, [], bits)
    return enclose(system, z, [], bits)


def orbit_entry(family: Family, value: str, box: Box) -> Entry:
    """The orbit for a certificate, with a basis that shows its multipliers plainly."""
    return orbit_box(family.motif, box, value, basis_texts(family.system(ball(value)), box.balls()[0]))


def _shifted(center: str, sign: int, distance: str) -> str:
    with localcontext() as context:
        context.prec = 80
        return str(Decimal(center) + sign * Decimal(distance)).lower()
