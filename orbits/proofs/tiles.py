"""Tiles: boxes about a branch over an interval of the parameter, in each of which the orbits form exactly one curve.

For p = p_c + q, |q| <= h, a tile is the set m + s q + [-r, r] with the branch's tangent s. With J any matrix of DF over the whole tile,

    J^{-1} F(m + s q, p_c + q)  inside (-r, r)    for all q

proves one solution for each p (the interval Newton operator with the moving middle m + s q). F there is enclosed by its value
at q = 0 and its derivative along (s, 1), which is small since s is tangent: r shrinks like h^2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from orbits.proofs.balls import ball, library, texts, upper_text
from orbits.proofs.elimination import Singular, solve
from orbits.proofs.equations import Motif
from orbits.proofs.jets import Jet, partial
from orbits.proofs.special import AtParameter

ROUNDS = 6
SLACK = 1.3  # so much smaller than the tile is the image, that another arithmetic finds it inside as well


@dataclass(frozen=True)
class Tile:
    """One tile, all numbers as exact decimals.

    Attributes
    ----------
    center, half : str
        p_c and h.
    nodes : list (l) of lists (n) of [middle, slope, radius]
    basis : list (n) of lists (n) of str
        Columns in which the linearised map shows its stability plainly.
    """

    center: str
    half: str
    nodes: list[list[list[str]]]
    basis: list[list[str]]

    def values(self) -> Any:
        """The ball of the parameter."""
        return library().arb(self.center, self.half)

    def balls(self) -> list[list[Any]]:
        """The whole tile as balls."""
        arb = library().arb
        q = arb(0, self.half)
        return [[arb(m, r) + arb(s) * q for m, s, r in node] for node in self.nodes]

    def at(self, p: Any) -> list[list[Any]]:
        """The part of the tile at one value of the parameter."""
        arb = library().arb
        q = p - arb(self.center)
        return [[arb(m, r) + arb(s) * q for m, s, r in node] for node in self.nodes]

    @property
    def radius(self) -> float:
        """The largest radius at one value of the parameter."""
        return max(float(r) for node in self.nodes for _, _, r in node)


def lay(
    motif: Motif, p: Mapping[str, Any], name: str, center: str, half: str, middle: Sequence[Sequence[Any]]
) -> Tile | None:
    """The tile about the refined nodes `middle` at parameter value `center`, None if none is proved."""
    arb = library().arb
    system = AtParameter(motif, p, name)
    at, span = ball(center), arb(0, half)
    mids = [[texts(v.mid(), 30)[0] for v in node] for node in middle]
    m = [[ball(text) for text in node] for node in mids]
    try:
        slopes = [[texts((-v).mid(), 24)[0] for v in node] for node in _tangent(system, m, at)]
        s = [[ball(text) for text in node] for node in slopes]
        F = _residual(system, m, s, at, span)
        radii = [[2 * v.abs_upper() + arb(2) ** (-60) for v in node] for node in _solved(system, m, at, F)]
        for _ in range(ROUNDS):
            decimals = [[upper_text(r) for r in node] for node in radii]
            nodes = [[list(triple) for triple in zip(*rows)] for rows in zip(mids, slopes, decimals)]
            tile = Tile(center, half, nodes, [])
            step = _solved(system, tile.balls(), tile.values(), F)
            inside = all(
                SLACK * v.abs_upper() < arb(r) for part, row in zip(step, decimals) for v, r in zip(part, row)
            )
            if inside:
                return tile
            radii = [
                [(1.7 * v.abs_upper()).max(r / 4) + arb(2) ** (-60) for v, r in zip(part, row)]
                for part, row in zip(step, radii)
            ]
            if not all(r.is_finite() and r < 1 for row in radii for r in row):
                return None
    except Singular:
        pass
    return None


def joined(one: Tile, other: Tile, point: Sequence[Sequence[Any]], p: Any) -> bool:
    """Whether a proved orbit at `p` lies in both tiles: then their curves are one."""
    return all(
        large.contains_interior(small)
        for tile in (one, other)
        for node, part in zip(tile.at(p), point)
        for large, small in zip(node, part)
    )


def _tangent(system: AtParameter, m: Any, at: Any) -> list[list[Any]]:
    """DF^{-1} dF/dp at the middle."""
    blocks = system.linearise(m, [at])
    blocks.b = [[row[0] for row in E] for E in blocks.E]
    return _square(blocks)


def _solved(system: AtParameter, Z: Any, P: Any, F: Any) -> list[list[Any]]:
    blocks = system.linearise(Z, [P])
    blocks.b = F
    return _square(blocks)


def _square(blocks: Any) -> list[list[Any]]:
    blocks.E = [[[] for _ in E] for E in blocks.E]
    return solve(blocks)[0]


def _residual(system: AtParameter, m: Any, s: Any, at: Any, span: Any) -> list[list[Any]]:
    """Enclosures of F(m + s q, p_c + q) for all q in the span."""
    value, _ = system.residuals(m, [at])
    moving = [
        [Jet(mid + slope * span, {0: slope}) for mid, slope in zip(node, row)] for node, row in zip(m, s)
    ]
    extras = [Jet(at + span, {0: library().arb(1)})]
    change, _ = system.residuals(moving, extras)
    return [[a + partial(b, 0) * span for a, b in zip(x, y)] for x, y in zip(value, change)]
