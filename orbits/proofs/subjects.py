"""Proofs for the objects of users (orbits, problems): convert them to words, nodes and decimals, and prove them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Protocol

import numpy as np

from contvines.shared.near_names import no_parameter
from orbits.cycle import root_orbit
from orbits.flows import flow_of
from orbits.proofs.balls import Given, decimal
from orbits.proofs.checks import check_symmetry, motif_of
from orbits.proofs.equations import Motif, Varying
from orbits.proofs.flights import parameter_names
from orbits.proofs.obstacles import ProofError
from orbits.proofs.pieces import BITS, Pieces, prove_piece
from orbits.proofs.proof import Proof
from orbits.proofs.prove import MULTIPLIERS, prove_orbit, prove_special, prove_stuck
from orbits.settings import PROVING
from orbits.words import Word, margin_name

if TYPE_CHECKING:
    from orbits.cycle import Cycle
    from orbits.machines.varying import Varying as VaryingMachine


CRITICAL = (*MULTIPLIERS, "neimark-sacker")
PLAIN = ("end", "user")  # kinds of special points that are ordinary orbits


class Motions(Protocol):
    """The attributes of `orbits.problem.OrbitProblem` that proofs use."""

    model: VaryingMachine
    word: Word
    periods: int
    symmetric: bool
    parameter: str

    @property
    def dimension(self) -> int: ...
    @property
    def path(self) -> Iterable[np.ndarray]: ...
    def orbit(self, u: np.ndarray, p: float) -> Cycle: ...
    def expand(self, u: np.ndarray, p: float) -> np.ndarray: ...


class Special(Protocol):
    """The attributes of a special point that proofs use."""

    kind: str
    u: np.ndarray
    value: float
    margin_index: int | None


def of_orbit(orbit: Cycle, bits: int | None = None, **parameters: Given) -> Proof:
    """Prove an `Orbit`.

    Parameters
    ----------
    orbit : Orbit
    bits : int, optional
        Precision at the beginning.
    **parameters
        Values that replace the orbit's floats: exact decimals as text, or balls (middle, radius).

    Raises
    ------
    ProofError
        If the machine has no flights in closed form, or a parameter is unknown or out of range.
    """
    _refuse_pages(orbit.model)
    given = _parameters(orbit.model.name, _numbers(orbit), parameters)
    if not len(orbit.word):
        return prove_stuck(orbit.model.name, given, bits or 160)
    word = orbit.word
    return prove_orbit(
        orbit.model.name,
        word.events,
        word.mode_codes.tolist(),
        orbit.periods,
        orbit.nodes,
        given,
        half=bool(orbit.symmetric and _mirrored(orbit, given)),
        frictionless=word.frictionless,
        bits=bits,
    )


def of_point(
    problem: Motions, kind: str, u: np.ndarray, p: float, margin: int | None = None, bits: int | None = None
) -> Proof:
    """Prove a special point of an `OrbitProblem`.

    Parameters
    ----------
    problem : OrbitProblem
    kind : str
        Kind of the special point.
    u, p : float array (N,), float
        Unknowns and parameter at the point.
    margin : int, optional
        At a border the index of the margin that vanishes.
    bits : int, optional
        Precision at the beginning.

    Raises
    ------
    ProofError
        If the machine has no flights in closed form, or the point cannot be proved in this form.
    """
    _refuse_pages(problem.model)
    orbit = problem.orbit(u, p)
    if kind in PLAIN:
        return of_orbit(orbit, bits)
    machine = orbit.model.name
    varying = _varying_numbers(problem)
    given = _parameters(machine, _numbers(orbit), {})
    if not len(orbit.word):
        motif = Motif(machine, (), (), 1, False, False)
        return prove_special(
            kind, motif, np.zeros((0, 1)), given, varying, float(p), margin=("hold", 0), bits=bits
        )
    word, periods, nodes, half = orbit.word, orbit.periods, orbit.nodes, problem.symmetric
    if kind in CRITICAL or kind == "branch-point":
        kind, word, periods, nodes, half = _critical(kind, word, periods, nodes, half, orbit.symmetric)
    motif = motif_of(machine, word.events, word.mode_codes.tolist(), periods, half, word.frictionless)
    vanishing = None
    if kind not in CRITICAL:
        if margin is None:
            raise ProofError(f"a {kind} needs the margin that vanishes there")
        vanishing = (_margin(word, margin), margin // len(word.alphabet.columns))
    return prove_special(
        kind, motif, nodes[: len(motif)], given, varying, float(p), margin=vanishing, bits=bits
    )


def of_branch(
    problem: Motions,
    points: np.ndarray,
    values: np.ndarray,
    marks: Sequence[int] = (),
    within: tuple[float, float] | None = None,
    special: Mapping[int, Special] | None = None,
    bits: int | None = None,
) -> Pieces:
    """Prove a branch of an `OrbitProblem`, or its part within an interval of the parameter.

    Parameters
    ----------
    problem : OrbitProblem
    points, values : float arrays (n, N), (n,)
        Unknowns and parameter values along the branch.
    marks : sequence of int
        Indices of special points, at which stretches end.
    within : (float, float), optional
        Interval of the parameter to which every stretch is restricted.
    special : dict, optional
        Index -> special point (with `kind`, `u`, `value` and `margin_index`). A stretch includes a special point that can be proved with the
        word of the branch, and a plain end; at other special points, where verdicts change, a hundredth of the stretch is left out.
    bits : int, optional
        Precision of stretches, and the first one to try for special points.

    Raises
    ------
    ProofError
        If nothing of the branch lies in the interval, or the problem has no equations to prove.
    """
    _refuse_pages(problem.model)
    if not len(problem.word):
        raise ProofError(
            "the absorber is stuck throughout: prove single orbits and special points of this branch"
        )
    orbit = problem.orbit(points[0], float(values[0]))
    machine, word = orbit.model.name, problem.word
    varying = _varying_numbers(problem)
    given = _parameters(machine, _numbers(orbit), {})
    motif = motif_of(
        machine, word.events, word.mode_codes.tolist(), problem.periods, problem.symmetric, word.frictionless
    )
    turns = 1 + np.flatnonzero(np.diff(np.sign(np.diff(values))))
    cuts = sorted({0, len(values) - 1, *(int(i) for i in turns), *(int(i) for i in marks)})
    proofs: dict[int, Proof | None] = {}

    def point(place: int) -> Proof | None:
        if place not in proofs:
            proofs[place] = _joinable(problem, motif, (special or {}).get(place), bits)
        return proofs[place]

    def plain(place: int) -> bool:
        found = (special or {}).get(place)
        return found is not None and found.kind in PLAIN

    pieces, between = [], []
    for first, last in pairwise(cuts):
        order = np.argsort(values[first : last + 1])
        x, u = values[first : last + 1][order], points[first : last + 1][order]
        low, high = float(x[0]), float(x[-1])
        places = (first, last) if order[0] < order[-1] else (last, first)
        ends: list[Proof | None] = [None, None]
        inner = 0.01 * (high - low)
        if within is not None:
            low, high = max(low, within[0]), min(high, within[1])
        if not high > low:
            continue
        if low == float(x[0]):
            ends[0] = point(places[0])
            low += 0.0 if ends[0] or plain(places[0]) else inner
        if high == float(x[-1]):
            ends[1] = point(places[1])
            high -= 0.0 if ends[1] or plain(places[1]) else inner
        if not high > low:
            continue

        def guess(p: float, x: np.ndarray = x, u: np.ndarray = u) -> np.ndarray:
            columns = [np.interp(p, x, u[:, j]) for j in range(u.shape[1])]
            return problem.expand(np.array(columns), p)[: len(motif)]

        between.append((first, last))
        pieces.append(prove_piece(motif, guess, given, varying, low, high, (ends[0], ends[1]), bits or BITS))
    if not pieces:
        raise ProofError("the branch has no stretch between special points in this interval")
    return Pieces(tuple(pieces), tuple(between))


def _joinable(problem: Motions, motif: Motif, found: Special | None, bits: int | None) -> Proof | None:
    """Prove a special point with the word of the branch, so that a stretch can include it; None if this is not possible."""
    if found is None or found.kind in PLAIN or np.size(found.u) != problem.dimension:
        return None
    try:
        proof = of_point(problem, found.kind, found.u, float(found.value), found.margin_index, bits)
    except ProofError:
        return None
    wide = bool(proof.chain) and float(proof.chain[1]["half_width"]) > PROVING.narrow
    return proof if wide and proof.motif == motif else None


def _critical(
    kind: str, word: Word, periods: int, nodes: np.ndarray, half: bool, symmetric: bool
) -> tuple[str, Word, int, np.ndarray, bool]:
    """Return kind, word, periods, nodes and half of the description of an orbit in which only one multiplier is critical.

    A repeated word is replaced by its root, and a symmetric orbit at a symmetry breaking by half of it.
    """
    root, root_periods, root_nodes = root_orbit(word, periods, nodes)
    if not half and len(root) < len(word) and kind in ("period-doubling", "branch-point"):
        return "period-doubling", root, root_periods, root_nodes, False
    if not half and kind in ("symmetry-breaking", "branch-point") and symmetric:
        return "symmetry-breaking", word, periods, nodes, True
    return ("fold" if kind == "branch-point" else kind), word, periods, nodes, half


def _refuse_pages(model: VaryingMachine) -> None:
    """Raise a `ProofError` for a machine without closed forms."""
    if not flow_of(model).closed_form:
        raise ProofError(
            f"the machine {model.name!r} offers no proofs, for flights of declared machines have no closed form; "
            "the built-in machines do"
        )


def _margin(word: Word, index: int) -> str:
    """Name of a margin in proofs, see `orbits.proofs.special.Vanishing`."""
    name = margin_name(word, index)
    return "reversal" if word.frictionless and index % len(word.alphabet.columns) == 0 else name


def _numbers(orbit: Cycle) -> dict[str, float]:
    """Return the machine's dimensionless numbers, also for a machine in physical units."""
    return orbit.model.named(orbit.params)


def _mirrored(orbit: Cycle, given: Mapping[str, Given]) -> bool:
    """Whether the mirror images of motions are motions of the machine with exactly these parameters."""
    word = orbit.word
    try:
        check_symmetry(
            motif_of(
                orbit.model.name,
                word.events,
                word.mode_codes.tolist(),
                orbit.periods,
                True,
                word.frictionless,
            ),
            {name: decimal(value) for name, value in given.items()},
        )
    except ProofError:
        return False
    return True


def _parameters(machine: str, own: Mapping[str, float], changed: Mapping[str, Given]) -> dict[str, Given]:
    names = parameter_names(machine)
    for name in changed:
        if name not in names:
            raise ProofError(no_parameter(name, f"the machine {machine!r}", names))
    return {name: changed.get(name, own[name]) for name in names}


def _varying_numbers(problem: Motions) -> Varying:
    """Return the machine's numbers that depend on the problem's parameter."""
    names = parameter_names(problem.model.name)
    varied = {
        name: (repr(float(factor)), int(power) if float(power).is_integer() else float(power))
        for name, factor, power in zip(problem.model.parameter_names, *problem.path)
        if power != 0.0 and name in names
    }
    if not varied:
        raise ProofError(
            f"{problem.parameter} moves no number that the motion depends on: a special point against it cannot be proved"
        )
    return Varying(
        problem.parameter,
        {name: ("1" if factor == "1.0" else factor, k) for name, (factor, k) in varied.items()},
    )
