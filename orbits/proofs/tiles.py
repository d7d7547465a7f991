"""Tiles: boxes around a branch, each of which contains exactly one curve of orbits.

One of the unknowns (nodes x and parameter p together) is the coordinate of the curve: the parameter or, at a fold, an unknown
of a node. It is c + q with |q| <= h. A tile is the set m + s q + [-r, r] with the tangent s of the branch. If, for all matrices J of DF over the tile,

    J^{-1} F(m + s q)  inside (-r, r)    for all q

then there is exactly one solution for each q (interval Newton operator with the moving middle m + s q). F(m + s q) is enclosed by its value
at q = 0 and its derivative along s, which is small because s is the tangent; so r decreases like h^2.

The defining system of a special point (`orbits.proofs.special`) encloses it to thirty digits. Its certificate needs less mathematics:
two orbits, one on each side of the point, and a tile that contains both. At one orbit the multiplier (or margin) lies on one side of its critical
value, at the other on the other side, and both orbits lie on one curve.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, localcontext
from typing import TYPE_CHECKING, Any

from orbits.proofs.balls import ball, library, texts, upper_text
from orbits.proofs.elimination import Singular, solve
from orbits.proofs.enclosing import Box, enclose, refine
from orbits.proofs.jets import Jet, partial
from orbits.proofs.obstacles import Obstacle, Remedy, Step
from orbits.proofs.proof import Entry, box_entry, orbit_box, resting_box
from orbits.proofs.special import AtParameter, Family, Normal
from orbits.proofs.stability import away_from_one, basis_texts

if TYPE_CHECKING:
    from flint import arb

    from orbits.proofs.elimination import Nodes, Solution
    from orbits.proofs.equations import Motif
    from orbits.proofs.jets import Number


ROUNDS = 6  # attempts to find suitable radii
DIGITS = 60  # digits of middles; tiles of long words may be narrower than 1e-30
SLACK = 2.0  # factor between a tile and its image under the Newton operator, so that the checker's arithmetic also finds the image inside
LEVEL = 0.25  # smallest radius, relative to the largest
Place = tuple[int, int]
"""The unknown that is a tile's coordinate: node and component."""


class Along(AtParameter):
    """System of the branch with one unknown as coordinate (the parameter if `place` is None), which has the value `at`."""

    def __init__(self, family: Family, place: Place | None, at: Number) -> None:
        super().__init__(family)
        self.place, self.at = place, at
        block, component = place or (0, 0)
        self.borders = ((block, lambda z, e: (e[0] if place is None else z[component]) - self.at),)


@dataclass(frozen=True)
class Tile:
    """One tile; all numbers are exact decimals.

    Attributes
    ----------
    half : str
        Half-width h of the coordinate.
    nodes : list (l) of lists (n) of [middle, slope, radius]
    parameter : [middle, slope, radius]
    place : (int, int) or None
        Node and component of the coordinate, or None for the parameter; its radius is 0.
    basis : list (n) of lists (n) of str
        Basis (columns) in which the checker can verify stability.
    """

    half: str
    nodes: list[list[list[str]]]
    parameter: list[str]
    place: Place | None
    basis: list[list[str]]

    def values(self) -> arb:
        """Return the ball of all values of the parameter in the tile."""
        return _hull(self.parameter, library().arb(0, self.half))

    def balls(self) -> list[list[arb]]:
        """Return the nodes of the whole tile as balls."""
        q = library().arb(0, self.half)
        return [[_hull(triple, q) for triple in node] for node in self.nodes]

    def holds(self, value: str, box: Box) -> bool:
        """Whether a proved orbit at a value of the parameter lies in the tile, and so on its curve."""
        arb = library().arb
        triples = [*(triple for node in self.nodes for triple in node), self.parameter]
        point = [*(arb(*pair) for node in box.nodes for pair in node), ball(value)]
        at = len(triples) - 1 if self.place is None else self.place[0] * len(self.nodes[0]) + self.place[1]
        q = point[at] - arb(triples[at][0])
        inside = all(
            _hull(triple, q).contains_interior(part)
            for j, (triple, part) in enumerate(zip(triples, point))
            if j != at
        )
        return bool(arb(0, self.half).contains(q)) and inside

    def end(self, value: float) -> list[list[float]]:
        """Return approximate nodes at a value of the parameter along the tangent; the parameter must be the coordinate."""
        q = value - float(self.parameter[0])
        return [[float(m) + float(s) * q for m, s, _ in node] for node in self.nodes]

    @property
    def radius(self) -> float:
        """The largest radius at one value of the coordinate."""
        return max((float(r) for node in self.nodes for _, _, r in node), default=0.0)


def _hull(triple: Sequence[str], q: arb) -> arb:
    """Return the ball m + s q + [-r, r] of one unknown."""
    m, s, r = triple
    return library().arb(m, r) + library().arb(s) * q


def lay(along: Along, center: str, half: str, z: Nodes, value: arb) -> Tile | None:
    """Prove a tile around a refined orbit (nodes z, parameter `value`) whose coordinate is `center`; None if this fails."""
    arb = library().arb
    span = arb(0, half)
    mids = [[texts(v.mid(), DIGITS)[0] for v in node] for node in z]
    first = center if along.place is None else texts(value.mid(), DIGITS)[0]
    if along.place is not None:
        mids[along.place[0]][along.place[1]] = center
    m, p = [[ball(text) for text in node] for node in mids], ball(first)
    place = None if along.place is None else along.place[0] * along.k + along.place[1]
    try:
        along.at = Jet(ball(center), {0: arb(1)})
        slopes = [texts((-v).mid(), 30)[0] for v in _joined(_solved(along, m, [p], _tangent(along)))]
        slopes[-1 if place is None else place] = "1"
        s = [ball(text) for text in slopes]
        F = _residual(along, m, p, s, ball(center), span)
        least = arb(2) ** (-60) * arb(half).min(arb(1))
        radii = _levelled([1.5 * SLACK * v.abs_upper() + least for v in _joined(_solved(along, m, [p], F))])
        for _ in range(ROUNDS):
            decimals = [upper_text(r) for r in radii]
            decimals[-1 if place is None else place] = "0"
            triples = [
                list(triple)
                for triple in zip([*(text for node in mids for text in node), first], slopes, decimals)
            ]
            nodes = [triples[i : i + along.k] for i in range(0, len(triples) - 1, along.k)]
            tile = Tile(half, nodes, triples[-1], along.place, [])
            step = _joined(_solved(along, tile.balls(), [tile.values()], F))
            fixed = len(step) - 1 if place is None else place
            if all(
                SLACK * v.abs_upper() < arb(r) for j, (v, r) in enumerate(zip(step, decimals)) if j != fixed
            ):
                return tile
            radii = _levelled([(1.3 * SLACK * v.abs_upper()).max(r / 4) + least for v, r in zip(step, radii)])
            if not all(r.is_finite() and r < 1 for r in radii):
                return None
    except Singular:
        pass
    return None


def tile_box(motif: Motif, tile: Tile) -> Entry:
    """Return a tile as a box of a certificate."""
    return box_entry(motif, tile.nodes, tile.parameter, tile.half, tile.basis)


def _levelled(radii: list[arb]) -> list[arb]:
    """Enlarge small radii to `LEVEL` times the largest one, so that the checker's coarser bounds suffice."""
    largest = max(radii, key=float)
    return [r.max(LEVEL * largest) for r in radii]


def _joined(solution: Solution) -> list[arb]:
    return [*(v for node in solution[0] for v in node), *solution[1]]


def _tangent(along: Along) -> Solution:
    """Return the right side of the linear system whose solution is minus the tangent, with slope 1 of the coordinate."""
    return [[library().arb(0)] * along.k for _ in range(along.length)], [library().arb(-1)]


def _solved(along: Along, Z: Nodes, E: Sequence[arb], F: Solution) -> Solution:
    at, along.at = along.at, library().arb(0)  # a constant, which does not change the derivative
    try:
        blocks = along.linearise(Z, E)
    finally:
        along.at = at
    blocks.b, blocks.c = F
    return solve(blocks)


def _residual(
    along: Along, m: Nodes, p: arb, s: Sequence[arb], center: arb, span: arb
) -> tuple[list[list[Any]], list[arb]]:
    """Return enclosures of F(m + s q) for all q in the span."""
    k = along.k
    along.at = center
    value, _ = along.residuals(m, [p])
    moving = [
        [Jet(mid + s[i * k + j] * span, {0: s[i * k + j]}) for j, mid in enumerate(node)]
        for i, node in enumerate(m)
    ]
    along.at = Jet(center + span, {0: library().arb(1)})
    change, _ = along.residuals(moving, [Jet(p + s[-1] * span, {0: s[-1]})])
    inner = [[a + partial(b, 0) * span for a, b in zip(x, y)] for x, y in zip(value, change)]
    return inner, [library().arb(0)]  # the coordinate's own equation holds exactly


APART = ("2e-11", "2e-14", "2e-17", "2e-20", "2e-26", "2e-32", "2e-38")
"""Distances of the two orbits from the special point in the parameter, tried in turn: smaller ones serve sharp bends and long words."""
TURN = (
    "1e-6",
    "1e-8",
    "1e-10",
    "1e-13",
    "1e-19",
    "1e-25",
    "1e-31",
)  # the same at a fold, in the unknown that is the coordinate
WIDTH = 1.25  # half-width of the tile, relative to the distance of the orbits


def crossing(
    family: Family,
    z: Nodes,
    value: arb,
    bits: int,
    turn: Normal | None = None,
    pair: bool = False,
) -> list[Entry]:
    """Prove the chain (orbit, tile, orbit) around a special point.

    Parameters
    ----------
    family : Family
    z : list (l) of lists of arb
        Nodes of the special point, each followed by those of the eigenvector if there is one.
    value : arb
        The parameter at the special point.
    bits : int
        Precision.
    turn : Normal, optional
        At a fold the unknown that is the tile's coordinate.
    pair : bool
        Whether a pair of multipliers crosses the circle; then no multiplier may be 1 or -1 in the tile.

    Raises
    ------
    Obstacle
        If the tile or an orbit is not proved, or the orbits do not lie in the tile.
    """
    motif = family.motif
    if not len(motif):
        center, half = texts(value.mid(), DIGITS)[0], f"{float(APART[0]) * WIDTH:.3g}"
        low, high = (_shifted(center, sign, APART[0]) for sign in (-1, 1))
        return [resting_box(motif, low), resting_box(motif, center, half), resting_box(motif, high)]
    for distance in APART if turn is None else TURN:
        try:
            return _chain(family, z, value, bits, turn, distance, pair)
        except Obstacle as obstacle:
            if distance in (APART[-1], TURN[-1]):
                raise obstacle from None
    raise AssertionError("no distance to try")


def _chain(
    family: Family,
    z: Nodes,
    value: arb,
    bits: int,
    turn: Normal | None,
    distance: str,
    pair: bool,
) -> list[Entry]:
    """Do `crossing` with orbits at the distance `distance` from the point."""
    n = family.motif.node
    nodes = [list(node[:n]) for node in z]
    center = texts(value.mid(), DIGITS)[0]
    if turn is None:
        ends = [_shifted(center, sign, distance) for sign in (-1, 1)]
        along, starts = Along(family, None, ball(center)), [nodes, nodes]
    else:
        place = turn.block, turn.component
        center = texts(nodes[place[0]][place[1]].mid(), DIGITS)[0]
        along = Along(family, place, ball(_shifted(center, 1, distance)))
        starts = [
            [[a + b * ball(distance) * sign for a, b in zip(node[:n], node[n:])] for node in z]
            for sign in (-1, 1)
        ]
        _, (solution,) = refine(along, starts[1], [value], bits)
        ends = [texts(solution.mid(), DIGITS)[0]] * 2
        along.at = ball(center)
    tile = lay(along, center, f"{float(distance) * WIDTH:.3g}", nodes, value)
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
    """Prove the orbit near `start` at a value of the parameter.

    Raises
    ------
    Obstacle
        If existence is not proved.
    """
    system = family.system(ball(value))
    z, _ = refine(system, start, [], bits)
    return enclose(system, z, [], bits)


def orbit_entry(family: Family, value: str, box: Box) -> Entry:
    """Return the box of an orbit for a certificate, with a basis for the checker."""
    return orbit_box(family.motif, box, value, basis_texts(family.system(ball(value)), box.balls()[0]))


def _shifted(center: str, sign: int, distance: str) -> str:
    with localcontext() as context:
        context.prec = 80
        return str(Decimal(center) + sign * Decimal(distance)).lower()
