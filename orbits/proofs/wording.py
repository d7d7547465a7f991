"""Proofs in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from orbits.proofs.checks import SIDED
from orbits.proofs.equations import Motif
from orbits.proofs.obstacles import Obstacle
from orbits.words import Word
from orbits.words.alphabet import shaken

SAYS = {
    "real": {
        True: "real",
        False: "virtual (proved: no machine follows it)",
        None: "neither proved real nor virtual",
    },
    "stable": {True: "stable", False: "unstable", None: "stability not proved"},
}


class Claim(Protocol):
    """What is said of whatever is proved."""

    @property
    def motif(self) -> Motif: ...
    @property
    def parameters(self) -> Mapping[str, Any]: ...
    @property
    def parameter(self) -> str | None: ...
    @property
    def real(self) -> bool | None: ...
    @property
    def stable(self) -> bool | None: ...
    @property
    def obstacles(self) -> Sequence[Obstacle]: ...


class OfOrbit(Claim, Protocol):
    """What is said of an orbit or a special point (`orbits.proofs.proof.Proof`)."""

    @property
    def kind(self) -> str: ...
    @property
    def existence(self) -> bool: ...
    @property
    def radius(self) -> float | None: ...
    @property
    def value(self) -> Sequence[str] | None: ...
    @property
    def broken(self) -> tuple[str, int] | None: ...


class OfPiece(Claim, Protocol):
    """What is said of a piece of a branch (`orbits.proofs.pieces.Piece`)."""

    @property
    def asked(self) -> tuple[float, float]: ...
    @property
    def covered(self) -> tuple[str, str] | None: ...
    @property
    def ends(self) -> tuple[str | None, ...]: ...
    @property
    def count(self) -> int: ...


def spelling(proof: Claim) -> str:
    """The word of what is proved, as tables and pictures have it: one spelling for one motion."""
    motif = proof.motif
    word = Word(tuple(motif.events), tuple(motif.modes), shaken(motif.frictionless))
    if not motif.half:
        return word.spelled(_mirrored(proof))
    return f"symmetric {word.with_image().spelled()}"


def _mirrored(proof: Claim) -> bool:
    """Whether mirror images are motions of the machine, however the enclosed parameter varies."""
    known = proof.parameters
    alike = all(known.get(f"{name}_left") == known.get(f"{name}_right") for name in SIDED)
    return alike and float(known.get("slope", 0.0 if proof.motif.machine != "cavity" else 1.0)) == 0.0


def sentence(proof: OfOrbit) -> str:
    """What an `orbits.proofs.proof.Proof` proves, and what was in the way."""
    word = spelling(proof)
    what = "the orbit" if proof.kind == "orbit" else f"the {proof.kind}"
    if not proof.existence:
        lines = [f"{what} of {word}: existence not proved"]
    else:
        facts = [f"exists, one and only one within {proof.radius:.2g}"]
        if proof.value is not None:
            facts.append(f"{proof.parameter} = {proof.value[0][:24]} within {float(proof.value[1]):.1g}")
            facts.append("transversal")
        facts.append(SAYS["real"][proof.real])
        if proof.kind == "orbit":
            facts.append(SAYS["stable"][proof.stable])
        lines = [f"{what} of {word}: " + ", ".join(facts)]
    if proof.broken is not None:
        lines.append(f"  the margin {proof.broken[0]!r} of event {proof.broken[1]} is negative")
    lines += [f"  {obstacle}" for obstacle in proof.obstacles]
    return "\n".join(lines)


def piece_sentence(piece: OfPiece) -> str:
    """What an `orbits.proofs.pieces.Piece` proves of a piece of a branch."""
    word = spelling(piece)
    lines = []
    if piece.covered:
        low, high = (
            f"the {kind} at {float(at):.10g}" if kind else f"{float(at):.10g}"
            for kind, at in zip(piece.ends, piece.covered)
        )
        facts = ["exactly one near the branch", SAYS["real"][piece.real], SAYS["stable"][piece.stable]]
        lines.append(
            f"the orbits of {word}: {', '.join(facts)}, for all {piece.parameter} from {low} to {high} "
            f"({piece.count} boxes)"
        )
    else:
        lines.append(f"the orbits of {word} from {piece.asked[0]:g} to {piece.asked[1]:g}: not proved")
    lines += [f"  {obstacle}" for obstacle in piece.obstacles]
    return "\n".join(lines)
