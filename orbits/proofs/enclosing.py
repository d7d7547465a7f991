"""Existence and local uniqueness: Newton's method at high precision, then the interval Newton operator.

If m is the middle of a box X and every real matrix in DF(X) is regular, then

    N(X) = m - DF(X)^{-1} F(m)  inside X    implies    exactly one zero of F in X, and it lies in N(X)

(Neumaier, *Interval Methods for Systems of Equations*, theorem 5.1.7: F(x) - F(m) = J (x - m) with J in DF(X), so zeros are fixed
points of the continuous map x -> m - J(x)^{-1} F(m), which has one in X by Brouwer's theorem; with two zeros some J would be singular.)
If F depends on parameters that are balls, the statement holds for each of their values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from orbits.proofs.balls import ball, library, texts, upper_text
from orbits.proofs.elimination import Singular, solve
from orbits.proofs.equations import System
from orbits.proofs.obstacles import Obstacle, Remedy, Step
from orbits.settings import PROVING

if TYPE_CHECKING:
    from flint import arb

    from orbits.proofs.elimination import Nodes, Solution

ROUNDS = 8  # attempts to find a box of suitable width
T = TypeVar("T")


@dataclass(frozen=True)
class Box:
    """A box that contains exactly one solution.

    Attributes
    ----------
    nodes : list (l) of lists (k) of [middle, radius]
        Unknowns of each block, as decimal text.
    extras : list (m) of [middle, radius]
        Further unknowns.
    """

    nodes: list[list[list[str]]]
    extras: list[list[str]]

    def balls(self) -> Solution:
        """Return the box as balls, at the current precision."""
        arb = library().arb
        nodes = [[arb(mid, rad) for mid, rad in node] for node in self.nodes]
        return nodes, [arb(mid, rad) for mid, rad in self.extras]

    @property
    def radius(self) -> float:
        """The largest radius."""
        every = [pair for node in self.nodes for pair in node] + self.extras
        return max((float(rad) for _, rad in every), default=0.0)


def refine(system: System, nodes: Nodes, extras: Sequence[arb], bits: int) -> Solution:
    """Refine a solution by Newton's method until it converges; only the middles of all balls are used, also of the parameters.

    Raises
    ------
    Obstacle
        If a derivative is singular, the iteration leaves the neighbourhood of the start, or does not converge.
    """
    balls = system.p
    system.p = {name: value.mid() for name, value in balls.items()}
    try:
        return _newton(system, nodes, extras, bits)
    finally:
        system.p = balls


def _newton(system: System, nodes: Nodes, extras: Sequence[arb], bits: int) -> Solution:
    z = [[value.mid() for value in node] for node in nodes]
    e = [value.mid() for value in extras]
    goal = library().arb(2) ** (-(3 * bits) // 4)
    before = None
    for _ in range(24):
        try:
            dz, de = _step(system, z, e, z, e)
        except Singular:
            raise Obstacle(Step.REFINEMENT, Remedy.DEGENERATE) from None
        moved = max(float(v.abs_upper()) for part in (*dz, de) for v in part) if dz else 0.0
        if not moved < 0.3 or (before is not None and moved > PROVING.near and moved > 10 * before):
            raise Obstacle(Step.REFINEMENT, Remedy.START)
        z = [[(v - d).mid() for v, d in zip(node, part)] for node, part in zip(z, dz)]
        e = [(v - d).mid() for v, d in zip(e, de)]
        if moved < goal or (before is not None and before < PROVING.rounded and moved >= before):
            return z, e
        before = moved
    raise Obstacle(Step.REFINEMENT, Remedy.BITS)


def _step(system: System, z: Nodes, e: Sequence[arb], Z: Nodes, E: Sequence[arb]) -> Solution:
    """Return an enclosure of DF(Z, E)^{-1} F(z, e)."""
    blocks = system.linearise(Z, E)
    blocks.b, blocks.c = system.residuals(z, e)
    return solve(blocks)


def enclose(system: System, z: Nodes, e: Sequence[arb], bits: int) -> Box:
    """Find a box around (z, e) that contains exactly one solution.

    Raises
    ------
    Obstacle
        If no box is found.
    """
    digits = max(24, int(0.3 * bits))
    flat = [v for node in z for v in node] + list(e)
    mids = [texts(v.mid(), digits)[0] for v in flat]
    middle = [ball(text) for text in mids]
    zm, em = _shape(middle, system)
    floor = library().arb(2) ** (-bits // 2)
    wide = [floor * _scale(v) for v in middle]
    try:
        dz, de = _step(system, zm, em, zm, em)
        wide = [w + 2 * d.abs_upper() for w, d in zip(wide, [v for part in dz for v in part] + de)]
        for _ in range(ROUNDS):
            radii = [upper_text(w) for w in wide]
            box = [library().arb(mid, rad) for mid, rad in zip(mids, radii)]
            dz, de = _step(system, zm, em, *_shape(box, system))
            image = [v - d for v, d in zip(middle, [v for part in dz for v in part] + de)]
            if not all(v.is_finite() for v in image):
                break
            if all(large.contains_interior(small) for small, large in zip(image, box)):
                pairs = [[mid, rad] for mid, rad in zip(mids, radii)]
                nodes, extras = _shape(pairs, system)
                return Box(nodes, extras)
            wide = [
                (1.2 * (small - v).abs_upper() + w / 4).upper() for small, v, w in zip(image, middle, wide)
            ]
    except Singular:
        pass
    raise Obstacle(Step.EXISTENCE, Remedy.BITS)


def _shape(flat: list[T], system: System) -> tuple[list[list[T]], list[T]]:
    """Split a flat list of all unknowns into those of the blocks and the further ones."""
    k, length = system.k, system.length
    return [flat[k * i : k * i + k] for i in range(length)], flat[k * length :]


def _scale(value: arb) -> arb:
    """Size of an unknown, at least 1."""
    size = value.abs_upper()
    return size if size > 1 else library().arb(1)
