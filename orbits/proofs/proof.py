"""Results of proofs, as text and JSON, and certificates for `orbits.proofs.checker`.

A certificate is a chain of boxes: orbit, tile, orbit ... tile, orbit. Each unknown of a box is [middle, slope, radius] as decimal text.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from platform import python_version
from typing import Any

from orbits.proofs.balls import ball, library, precision, texts
from orbits.proofs.enclosing import Box
from orbits.proofs.equations import Motif, Varying
from orbits.proofs.flights import parameter_names
from orbits.proofs.obstacles import Obstacle
from orbits.proofs.special import Vanishing
from orbits.proofs.wording import SAYS, said, spelling


@dataclass(frozen=True)
class Proof:
    """Proof of one orbit or one special point.

    Attributes
    ----------
    kind : str
        "orbit", or the kind of the special point.
    motif : Motif
        The word, and whether half of it is solved for.
    parameters : dict
        Name -> exact decimal, or (middle, radius); without the parameter that is an unknown at a special point.
    varying : Varying or None
        At a special point the parameter that is an unknown.
    box : Box or None
        Contains exactly one solution of the equations; None if existence was not proved.
    real : bool or None
        True: all margins are proved positive; False: one is proved negative; None: neither.
    stable : bool or None
        True: all multipliers are proved inside the unit circle; False: one is proved outside; None: neither, or a special point.
    broken : (str, int) or None
        Name and event of the margin that is proved negative.
    obstacles : tuple of Obstacle
        Steps that failed, with remedies.
    chain : tuple of dict
        Boxes of a special point's certificate: an orbit, a tile and an orbit around it (`orbits.proofs.tiles.crossing`).
    basis : tuple of sequences of str
        For an orbit's certificate: rows of a basis in which the checker can verify its stability.
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
        """Whether the box is proved to contain exactly one solution."""
        return self.box is not None

    @property
    def parameter(self) -> str | None:
        """At a special point the name of the parameter that is an unknown, else None."""
        return self.varying.name if self.varying else None

    @property
    def transversal(self) -> bool | None:
        """Whether a special point is proved to be transversal, which follows from a regular zero of its defining system; None for an orbit."""
        return None if self.parameter is None else self.existence

    @property
    def radius(self) -> float | None:
        """The largest radius of the balls of the nodes (and of the parameter at a special point)."""
        if self.box is None:
            return None
        n = self.motif.node
        pairs = [pair for node in self.box.nodes for pair in node[:n]]
        pairs += self.box.extras[:1] if self.parameter else []
        return max((float(rad) for _, rad in pairs), default=0.0)

    @property
    def value(self) -> list[str] | None:
        """Middle and radius of the parameter's ball at a special point, else None."""
        return self.box.extras[0] if self.box is not None and self.parameter is not None else None

    def nodes(self) -> list[list[list[str]]]:
        """Return the balls of all nodes of the whole word, in the order of an orbit's nodes."""
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
        """Return the proof as a dict for JSON."""
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
        """Return the certificate (exact inputs, balls, claims, versions) for `orbits.proofs.checker`, as a dict for JSON.

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
        entry = orbit_box(motif, self.box, basis=self.basis) if len(motif) else resting_box(motif)
        boxes = self.chain or [entry]
        return certificate(motif, self.parameters, self.varying, boxes, self.real, self.stable, self.bits)

    def __str__(self) -> str:
        word = spelling(self.motif, self.parameters)
        subject = "the orbit" if self.kind == "orbit" else f"the {self.kind}"
        if not self.existence:
            lines = [f"{subject} of {word}: existence not proved"]
        else:
            facts = [f"exists, one and only one within {self.radius:.2g}"]
            if self.value is not None:
                facts.append(f"{self.parameter} = {self.value[0][:24]} within {float(self.value[1]):.1g}")
                facts.append("transversal")
            facts.append(SAYS["real"][self.real])
            if self.kind == "orbit":
                facts.append(SAYS["stable"][self.stable])
            lines = [f"{subject} of {word}: " + ", ".join(facts)]
        if self.broken is not None:
            lines.append(f"  the margin {self.broken[0]!r} of event {self.broken[1]} is negative")
        return said(lines, self.obstacles)


def _negated(pair: list[str]) -> list[str]:
    middle, radius = pair
    return [middle[1:] if middle.startswith("-") else middle if middle == "0" else "-" + middle, radius]


FORMAT = "contvines certificate 3"
Entry = dict[str, Any]


def plain(text: str) -> str:
    """Return a decimal in the notation of certificates."""
    number = Decimal(text)
    return str(number).lower() if number else "0"


def orbit_box(motif: Motif, box: Box, value: str = "1", basis: Sequence[Sequence[str]] = ()) -> Entry:
    """Return the box of a proved orbit; `value` is that of the varying parameter, if there is one."""
    nodes = [[[mid, "0", rad] for mid, rad in node[: motif.node]] for node in box.nodes]
    return box_entry(motif, nodes, [plain(value), "0", "0"], "0", basis)


def resting_box(motif: Motif, value: str = "1", half: str = "0") -> Entry:
    """Return the box of the stuck absorber at a value of the parameter, or on the interval `value` +- `half`."""
    return box_entry(motif, [], [plain(value), "0" if half == "0" else "1", "0"], half, ())


def box_entry(
    motif: Motif,
    nodes: Sequence[Sequence[Sequence[str]]],
    parameter: list[str],
    half: str,
    basis: Sequence[Sequence[str]],
) -> Entry:
    """Return one box of a certificate; the stuck absorber has zero nodes, and the default basis is the unit matrix."""
    n = motif.node
    unit = [["1" if i == j else "0" for j in range(n)] for i in range(n)]
    return {
        "nodes": nodes or [[["0", "0", "0"]] * n],
        "parameter": parameter,
        "half_width": half,
        "basis": [list(row) for row in basis] or unit,
        "kind": None,
        "conditions": [],
    }


def conditions(motif: Motif, vanishing: Vanishing) -> list[list[str | int]]:
    """Return the checker's key [name, event, side] of the inequality that changes at a border."""
    if vanishing.name in ("flight", "turn", "slip"):
        return [["flight", vanishing.event, motif.modes[vanishing.event]]]
    return [["wall" if vanishing.name == "wall" else "flight", vanishing.event, vanishing.side]]


def certificate(
    motif: Motif,
    parameters: Mapping[str, Any],
    varying: Varying | None,
    boxes: Sequence[Entry],
    real: bool | None,
    stable: bool | None,
    bits: int,
) -> Entry:
    """Return the whole certificate as a dict for JSON."""
    return {
        "format": FORMAT,
        "parameters": numbers(motif.machine, parameters, varying),
        "events": "".join(motif.events) or "o",
        "modes": list(motif.modes) or [0],
        "periods": motif.periods,
        "half": motif.half,
        "frictionless": motif.frictionless,
        "boxes": list(boxes),
        "claims": {"existence": True, "real": real, "stable": stable},
        "bits": bits,
        "versions": {"python-flint": library().__version__, "python": python_version()},
    }


def numbers(machine: str, parameters: Mapping[str, Any], varying: Varying | None) -> dict[str, list[str]]:
    """Return [middle, radius, exponent] of each of the machine's numbers; the parameter to this exponent multiplies the number."""
    varied = varying.numbers if varying else {}
    given: dict[str, list[str]] = {}
    for name in parameter_names(machine):
        if name in varied:
            factor, exponent = varied[name]
            given[name] = [plain(factor), "0", plain(str(Decimal(exponent)))]
        else:
            value = parameters[name] if name != "slope" else parameters.get(name, "0")
            middle, radius = (value, "0") if isinstance(value, str) else value
            given[name] = [plain(middle), plain(radius), "0"]
    return given
