"""Proofs of a graph's points, orbits and branches, by label: the problems prove, the graph stores claims and certificates."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from ..branches import Branch

if TYPE_CHECKING:
    from . import Graph


@runtime_checkable
class Proof(Protocol):
    """Protocol of a proof of a special point, a solution or a branch."""

    @property
    def existence(self) -> bool: ...
    @property
    def real(self) -> bool | None: ...
    @property
    def stable(self) -> bool | None: ...
    @property
    def radius(self) -> float | None: ...
    @property
    def obstacles(self) -> Iterable[object]: ...
    def certificate(self) -> dict[str, Any]: ...


class Piece(Protocol):
    """Protocol of the proved claims on a stretch of a branch."""

    @property
    def covered(self) -> tuple[float, float] | None: ...
    @property
    def ends(self) -> Iterable[object]: ...
    @property
    def real(self) -> bool | None: ...
    @property
    def stable(self) -> bool | None: ...


@runtime_checkable
class OfBranch(Proof, Protocol):
    """Protocol of a proof of a branch: pieces, and the indices of the points between which they lie."""

    @property
    def pieces(self) -> Sequence[Piece]: ...
    @property
    def places(self) -> Sequence[tuple[int, int]]: ...


@runtime_checkable
class Subject(Protocol):
    """Protocol of an object that can be proved."""

    def prove(self, **options: Any) -> Proof: ...


def subject(graph: Graph, label: str) -> object:
    """Return the object with a label: a special point, a branch, or with a colon one solution of a branch (``B1:12``).

    Raises
    ------
    KeyError
        If the graph has no such label.
    ValueError
        If the branch has no such point.
    """
    name, _, place = label.partition(":")
    found = graph[name]
    if not place:
        return found
    last = len(found) - 1 if isinstance(found, Branch) else -1
    if not (place.isdigit() and int(place) <= last):
        raise ValueError(
            f"{label}: {name} is a single point; leave out :{place}"
            if last < 0
            else f"{label}: the points of {name} are numbered from 0 to {last}; for example {name}:{last // 2}"
        )
    assert isinstance(found, Branch)
    return found.orbit(int(place))


def prove(graph: Graph, labels: Iterable[str] = (), **options: Any) -> dict[str, Any]:
    """Prove special points, solutions (``B1:12``) or whole branches; without labels all special points.

    Parameters
    ----------
    graph : Graph
    labels : iterable of str
    **options
        Arguments of the subjects' ``prove``.

    Returns
    -------
    dict
        The proofs by label; claims and certificates are stored in ``graph.proofs``, too.

    Raises
    ------
    KeyError
        If a label is unknown.
    ValueError
        If a problem has no proofs, or a branch has no such point.
    """
    wanted = list(labels) or list(graph.special)
    subjects: dict[str, Subject] = {}
    for label in wanted:
        target = subject(graph, label)
        if not isinstance(target, Subject):
            raise ValueError(
                f"{label}: its problem offers no proofs; machines of orbits with flights in closed form do"
            )
        subjects[label] = target
    found = {}
    for label, target in subjects.items():
        more = {"special": graph.special} if label in graph.branches else {}
        found[label] = proof = target.prove(**options, **more)
        graph.proofs[label] = kept(proof)
    return found


def kept(proof: Proof) -> dict[str, Any]:
    """Return the stored part of a proof: its claims, and the certificate if there is one."""
    parts = (
        [_stretch(*part) for part in zip(proof.pieces, proof.places)] if isinstance(proof, OfBranch) else []
    )
    return {
        "existence": bool(proof.existence),
        "real": proof.real,
        "stable": proof.stable,
        "radius": proof.radius,
        "obstacles": [str(obstacle) for obstacle in proof.obstacles],
        "certificate": (proof.certificate() or None) if proof.existence or parts else None,
        **({"stretches": parts} if parts else {}),
    }


def _stretch(piece: Piece, places: tuple[int, int]) -> dict[str, Any]:
    """Return the claims on a stretch of a branch, between two of its points, as a dict."""
    return {
        "between": list(places),
        "covered": [float(value) for value in piece.covered] if piece.covered else None,
        "ends": list(piece.ends),
        "real": piece.real,
        "stable": piece.stable,
    }
