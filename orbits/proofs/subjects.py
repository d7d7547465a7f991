"""What users hold (orbits, problems) as the proofs take it: words, nodes, decimals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from orbits.cycles.identity import is_symmetric, root_orbit
from orbits.cycles.margins import PER_NODE, margin_name
from orbits.proofs.balls import Given
from orbits.proofs.equations import Motif
from orbits.proofs.flights import parameter_names
from orbits.proofs.obstacles import ProofError
from orbits.proofs.pieces import Pieces, prove_piece
from orbits.proofs.proof import Proof
from orbits.proofs.prove import MULTIPLIERS, motif_of, prove_orbit, prove_special
from orbits.proofs.resting import prove_stuck
from orbits.words import Word

CRITICAL = (*MULTIPLIERS, "neimark-sacker")
PLAIN = ("end", "user")  # kinds of special points where nothing happens


def of_orbit(orbit: Any, bits: int | None = None, **parameters: Given) -> Proof:
    """Prove an `Orbit`.

    Parameters
    ----------
    orbit : Orbit
    bits : int, optional
        Precision to begin with.
    **parameters
        Parameters in place of the orbit's floats: exact decimals as text, or balls (middle, radius).

    Raises
    ------
    ProofError
        If the machine has no flights in closed form, or a parameter is unknown or out of range.
    """
    given = _parameters(orbit.model.name, orbit.parameters, parameters)
    if not len(orbit.word):
        return prove_stuck(orbit.model.name, given, bits or 160)
    word = orbit.word
    return prove_orbit(
        orbit.model.name,
        word.events,
        word.modes,
        orbit.periods,
        orbit.nodes,
        given,
        half=orbit.symmetric and orbit.model.name != "cavity",
        frictionless=word.frictionless,
        bits=bits,
    )


def of_point(
    problem: Any, kind: str, u: np.ndarray, p: float, margin: int | None = None, bits: int | None = None
) -> Proof:
    """Prove a special point of an `OrbitProblem`.

    Parameters
    ----------
    problem : OrbitProblem
    kind : str
        Kind of the special point.
    u, p : float array (N,), float
        Where it is.
    margin : int, optional
        At a border the index of the margin that vanishes.
    """
    orbit = problem.orbit(u, p)
    if kind in PLAIN:
        return of_orbit(orbit, bits)
    machine = orbit.model.name
    name, value = _moved(problem, p)
    given = _parameters(machine, orbit.parameters, {})
    if not len(orbit.word):
        motif = Motif(machine, (), (), 1, False, False)
        return prove_special(kind, motif, np.zeros((0, 1)), given, name, value, margin=("hold", 0), bits=bits)
    word, periods, nodes, half = orbit.word, orbit.periods, orbit.nodes, problem.symmetric
    if kind in CRITICAL or kind == "branch-point":
        kind, word, periods, nodes, half = _critical(kind, word, periods, nodes, half)
    motif = motif_of(machine, word.events, word.modes, periods, half, word.frictionless)
    vanishing = None
    if kind not in CRITICAL:
        if margin is None:
            raise ProofError(f"a {kind} needs the margin that vanishes there")
        vanishing = (_margin(word, margin), margin // PER_NODE)
    return prove_special(kind, motif, nodes[: len(motif)], given, name, value, margin=vanishing, bits=bits)


def of_branch(
    problem: Any,
    points: np.ndarray,
    values: np.ndarray,
    marks: Sequence[int] = (),
    within: tuple[float, float] | None = None,
) -> Pieces:
    """Prove a branch of an `OrbitProblem`, or its part within an interval of the parameter.

    Parameters
    ----------
    problem : OrbitProblem
    points, values : float arrays (n, N), (n,)
        The branch in its order.
    marks : sequence of int
        Places of special points: stretches end there. A hundredth is left out at either end, where verdicts change.
    within : (float, float), optional
        Prove just this interval, on each stretch as far as that reaches.

    Raises
    ------
    ProofError
        If nothing of the branch lies in the interval, or the problem has no equations to prove.
    """
    if not len(problem.word):
        raise ProofError(
            "the absorber is stuck throughout: prove single orbits and special points of this branch"
        )
    orbit = problem.orbit(points[0], float(values[0]))
    machine, word = orbit.model.name, problem.word
    name, _ = _moved(problem, float(values[0]))
    given = _parameters(machine, orbit.parameters, {})
    motif = motif_of(machine, word.events, word.modes, problem.periods, problem.symmetric, word.frictionless)
    numbers = np.array([_moved(problem, float(value))[1] for value in values])
    turns = 1 + np.flatnonzero(np.diff(np.sign(np.diff(numbers))))
    cuts = sorted({0, len(numbers) - 1, *(int(i) for i in turns), *(int(i) for i in marks)})
    pieces = []
    for first, last in pairwise(cuts):
        order = np.argsort(numbers[first : last + 1])
        x, u = numbers[first : last + 1][order], points[first : last + 1][order]
        low, high = float(x[0]), float(x[-1])
        if within is not None:
            low, high = max(low, within[0]), min(high, within[1])
        for end, at in ((low, 0), (high, -1)):
            if end == float(x[at]) and high > low:
                inner = 0.01 * (high - low)
                low, high = (low + inner, high) if at == 0 else (low, high - inner)
        if not high > low:
            continue

        def guess(p: float, x: np.ndarray = x, u: np.ndarray = u) -> np.ndarray:
            columns = [np.interp(p, x, u[:, j]) for j in range(u.shape[1])]
            return np.array(columns).reshape(len(motif), -1)

        pieces.append(prove_piece(motif, guess, given, name, low, high))
    if not pieces:
        raise ProofError("the branch has no stretch between special points in this interval")
    return Pieces(tuple(pieces))


def _critical(
    kind: str, word: Word, periods: int, nodes: np.ndarray, half: bool
) -> tuple[str, Word, int, np.ndarray, bool]:
    """The description of the orbit in which a multiplier is critical alone: the root, and half of a symmetric one."""
    root, root_periods, root_nodes = root_orbit(word, periods, nodes)
    if not half and len(root) < len(word) and kind in ("period-doubling", "branch-point"):
        return "period-doubling", root, root_periods, root_nodes, False
    if not half and kind in ("symmetry-breaking", "branch-point") and is_symmetric(word, periods, nodes):
        return "symmetry-breaking", word, periods, nodes, True
    return ("fold" if kind == "branch-point" else kind), word, periods, nodes, half


def _margin(word: Word, index: int) -> str:
    name = margin_name(word, index)
    return "reversal" if word.frictionless and index % PER_NODE == 0 else name


def _parameters(machine: str, own: Mapping[str, float], changed: Mapping[str, Given]) -> dict[str, Given]:
    names = parameter_names(machine)
    for name in changed:
        if name not in names:
            raise ProofError(f"{name} is no parameter of the machine {machine!r}; it has {', '.join(names)}")
    return {name: changed.get(name, own[name]) for name in names}


def _moved(problem: Any, p: float) -> tuple[str, float]:
    """The machine's number that the problem's parameter is, and its value."""
    names = parameter_names(problem.model.name)
    values = dict(zip(problem.model.parameter_names, (float(v) for v in problem.values(p))))
    powers = zip(problem.model.parameter_names, problem.path[1])
    moved = [name for name, power in powers if power != 0.0 and name in names]
    if len(moved) != 1:
        raise ProofError(
            f"{problem.parameter} moves {', '.join(moved) or 'no number'} of the machine at once; special points are proved "
            "where one number moves: continue in that one"
        )
    return moved[0], values[moved[0]]
