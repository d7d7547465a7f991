"""Checks before a proof: words without equations, symmetric halves without a mirror image, parameters out of range."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from decimal import Decimal
from typing import TYPE_CHECKING

import numpy as np

from orbits.proofs.balls import Given, ball
from orbits.proofs.equations import MIRRORED, Motif, Varying
from orbits.proofs.flights import MOVING, parameter_names
from orbits.proofs.obstacles import ProofError
from orbits.settings import PROVING

if TYPE_CHECKING:
    from flint import arb

SIDED = ("restitution", "friction")


def motif_of(
    machine: str, events: Sequence[str], modes: Sequence[int], periods: int, half: bool, frictionless: bool
) -> Motif:
    """Return the part of a word that is solved for: half of it if `half`, else all of it.

    Raises
    ------
    ProofError
        If the machine has no flights in closed form, or the word is empty.
    """
    parameter_names(machine)
    if not events:
        raise ProofError("the absorber is stuck throughout: the empty word has no equations to prove")
    length = len(events) // 2 if half else len(events)
    return Motif(machine, tuple(events[:length]), tuple(modes[:length]), periods, half, frictionless)


def require_mirror(
    motif: Motif,
    events: Sequence[str],
    modes: Sequence[int],
    nodes: np.ndarray,
    given: Mapping[str, Given],
) -> None:
    """Raise an error if the second half of an orbit is not the mirror image of the first.

    Raises
    ------
    ProofError
    """
    n = len(motif)
    image = -nodes[:n]
    image[:, 0] = nodes[:n, 0] + np.pi * motif.periods
    if "distance_left" in given:
        middle = float(ball(given["distance_left"]) - ball(given["distance_right"]))
        image[[letter not in MIRRORED for letter in motif.events], 1] += middle
    letters = tuple(MIRRORED.get(letter, letter) for letter in motif.events)
    same = tuple(events[n:]) == letters and tuple(modes[n:]) == tuple(-mode for mode in motif.modes)
    if not same or nodes.shape[0] != 2 * n or not np.max(np.abs(nodes[n:] - image)) < PROVING.near:
        raise ProofError(
            "the second half of the orbit is not the mirror image of the first: prove the whole word"
        )


def mirrored(given: Mapping[str, Given], varying: Varying | None = None) -> bool:
    """Whether the machine is symmetric, so that the mirror image of a motion is a motion: level cavity, equal restitutions, equal frictions."""
    numbers = {**given, **(varying.numbers if varying else {})}
    pairs = [(f"{name}_left", f"{name}_right") for name in SIDED if f"{name}_left" in numbers]
    level = Decimal(str(numbers.get("slope", "0"))) == 0
    return level and all(numbers[a] == numbers[b] and not isinstance(given.get(a), tuple) for a, b in pairs)


def check_symmetry(motif: Motif, given: Mapping[str, Given], varying: Varying | None = None) -> None:
    """Raise an error if half a word is to be solved for, but the machine is not symmetric or the number of periods is even.

    Raises
    ------
    ProofError
    """
    if motif.half and (motif.periods % 2 == 0 or not mirrored(given, varying)):
        raise ProofError(
            "half of a word stands for the whole only in a symmetric machine, over an odd number of periods"
        )


def check_parameters(motif: Motif, p: Mapping[str, arb]) -> None:
    """Raise an error for parameters out of range, and for friction that does not agree with the word.

    Raises
    ------
    ProofError
        The message names the parameter.
    """
    for name, value in p.items():
        if name.startswith("restitution"):
            good = value > 0 and value.upper() <= 1
        elif name in ("frequency",) or (name == "mass_ratio" and motif.machine in MOVING):
            good = value > 0
        else:
            good = name == "slope" or value.lower() >= 0
        if not (good and value.is_finite()):
            raise ProofError(f"{name} = {value.str(12)} is out of range for the machine {motif.machine!r}")
    limit = motif.flights(p).limit
    if not (limit[1] >= 0 and limit[-1] >= 0):
        raise ProofError("the slope leaves friction no load: keep it between -pi/2 and pi/2")
    if motif.frictionless != bool(limit[1] == 0 and limit[-1] == 0):
        raise ProofError(
            "a word without friction's events needs friction exactly 0, and any other needs friction above 0"
        )
