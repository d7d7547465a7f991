"""Texts of proofs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

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


def spelling(motif: Motif, parameters: Mapping[str, Any]) -> str:
    """Return the word of a proved motion in the spelling of tables and pictures, which is the same for a motion and its rotations."""
    word = Word(tuple(motif.events), tuple(motif.modes), shaken(motif.frictionless))
    if motif.half:
        return f"symmetric {word.with_image().spelled()}"
    # if both sides are equal, mirror images are motions of the machine for every value of the parameter
    symmetric = all(parameters.get(f"{name}_left") == parameters.get(f"{name}_right") for name in SIDED)
    slope = float(parameters.get("slope", 0.0 if motif.machine != "cavity" else 1.0))
    return word.spelled(symmetric and slope == 0.0)


def said(lines: Sequence[str], obstacles: Sequence[Obstacle]) -> str:
    """Join the lines of a proof and its obstacles."""
    return "\n".join([*lines, *(f"  {obstacle}" for obstacle in obstacles)])
