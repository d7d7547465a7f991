"""What a proof has found: data, for people and for files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from orbits.proofs.balls import ball, library, precision, texts
from orbits.proofs.certificates import Entry, certificate, orbit_box, resting_box
from orbits.proofs.enclosing import Box
from orbits.proofs.equations import Motif
from orbits.proofs.obstacles import Obstacle
from orbits.proofs.varying import Varying
from orbits.proofs.wording import SAYS, said, spelling


@dataclass(frozen=True)
class Proof:
    """What is proved of one orbit or one special point.

    Attributes
    ----------
    kind : str
        "orbit", or the kind of the special point.
    motif : Motif
        The word, and whether half of a symmetric orbit stands for the whole.
    parameters : dict
        Exact decimals, or (middle, radius); without the parameter that a special point solves for.
    varying : Varying or None
        At a special point the parameter that is enclosed.
    box : Box or None
        Holds exactly one solution of the equations; None where existence was not proved.
    real : bool or None
        All margins proved positive; one proved negative; neither.
    stable : bool or None
        All multipliers proved inside the unit circle; one proved outside; neither. Of special points only borders have it.
    broken : (str, int) or None
        The margin proved negative: name and event.
    obstacles : tuple of Obstacle
        What could not be proved, and what would help.
    chain : tuple of dict
        For a special point's certificate: an orbit, a tile and an orbit about it (`orbits.proofs.crossing`).
    basis : tuple of sequences of str
        For an orbit's certificate: rows of a basis that shows its stability plainly.
    bits : int
        Precision of the ball arithmetic.
    """

    kind: str
    motif: Motif
    parameters: Mapping[str, Any]
    varying: Varying | None = None
    box: Box | None = None
    real: bool | None = None
    stable: bool | None = None
    broken: tuple[str, int] | None = None
    obstacles: tuple[Obstacle, ...] = ()
    chain: tuple[Entry, ...] = ()
    basis: tuple[Sequence[str], ...] = ()
    bits: int = 0

    @property
    def existence(self) -> bool:
        """Whether exactly one solution is proved to lie in the box."""
        return self.box is not None

    @property
    def parameter(self) -> str | None:
        """At a special point the name of the parameter that is enclosed."""
        return self.varying.name if self.varying else None

    @property
    def transversal(self) -> bool | None:
        """At a special point: a regular zero of the defining system, which is what was proved, is transversal."""
        return None if self.parameter is None else self.existence

    @property
    def radius(self) -> float | None:
        """The largest radius of a node's (and a special point's parameter's) ball."""
        if self.box is None:
            return None
        n = self.motif.node
        pairs = [pair for node in self.box.nodes for pair in node[:n]]
        pairs += self.box.extras[:1] if self.parameter else []
        return max((float(rad) for _, rad in pairs), default=0.0)

    @property
    def value(self) -> list[str] | None:
        """At a special point middle and radius of the parameter's ball."""
        return self.box.extras[0] if self.box is not None and self.parameter is not None else None

    def nodes(self) -> list[list[list[str]]]:
        """The nodes' balls over the whole word, in the order of an orbit's nodes."""
        if self.box is None or not self.motif.events:
            return []
        n = self.motif.node
        nodes = [node[:n] for node in self.box.nodes]
        if not self.motif.half:
            return nodes
        with precision(self.bits):
            shift = library().arb.pi() * self.motif.periods
            digits = int(0.3 * self.bits)
            image = [
                [
                    texts(ball((node[0][0], node[0][1])) + shift, digits),
                    *(_negated(pair) for pair in node[1:]),
                ]
                for node in nodes
            ]
        return nodes + image

    def to_dict(self) -> dict[str, Any]:
        """The proof as JSON."""
        result = {
            "kind": self.kind,
            "existence": self.existence,
            "real": self.real,
            "stable": self.stable,
            "radius": self.radius,
            "nodes": self.nodes(),
            "parameters": {
                name: value if isinstance(value, str) else list(value)
                for name, value in self.parameters.items()
            },
            "obstacles": [obstacle.to_dict() for obstacle in self.obstacles],
            "bits": self.bits,
        }
        if self.broken is not None:
            result["broken"] = {"margin": self.broken[0], "event": self.broken[1]}
        if self.parameter is not None:
            result |= {"parameter": self.parameter, "value": self.value, "transversal": self.transversal}
        return result

    def certificate(self) -> dict[str, Any]:
        """All that a checker needs: exact inputs, balls, claims, versions; JSON.

        Raises
        ------
        ValueError
            If existence was not proved.
        """
        if self.box is None:
            raise ValueError(
                "nothing was proved, so there is no certificate: " + "; ".join(map(str, self.obstacles))
            )
        motif = self.motif
        alone = orbit_box(motif, self.box, basis=self.basis) if len(motif) else resting_box(motif)
        boxes = self.chain or [alone]
        return certificate(motif, self.parameters, self.varying, boxes, self.real, self.stable, self.bits)

    def __str__(self) -> str:
        word = spelling(self.motif, self.parameters)
        what = "the orbit" if self.kind == "orbit" else f"the {self.kind}"
        if not self.existence:
            lines = [f"{what} of {word}: existence not proved"]
        else:
            facts = [f"exists, one and only one within {self.radius:.2g}"]
            if self.value is not None:
                facts.append(f"{self.parameter} = {self.value[0][:24]} within {float(self.value[1]):.1g}")
                facts.append("transversal")
            facts.append(SAYS["real"][self.real])
            if self.kind == "orbit":
                facts.append(SAYS["stable"][self.stable])
            lines = [f"{what} of {word}: " + ", ".join(facts)]
        if self.broken is not None:
            lines.append(f"  the margin {self.broken[0]!r} of event {self.broken[1]} is negative")
        return said(lines, self.obstacles)


def _negated(pair: list[str]) -> list[str]:
    middle, radius = pair
    return [middle[1:] if middle.startswith("-") else middle if middle == "0" else "-" + middle, radius]
