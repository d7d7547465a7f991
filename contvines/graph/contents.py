"""Further contents of a graph: attractors found by simulation, proofs, and unresolved stretches.

A stretch of a branch is unresolved if its two ends disagree with the special points found between them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Protocol

from ..continuation.settings import Settings
from ..shared.motions import called
from ..shared.numbers import number_text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..branches import Branch

STABLE = {True: ", stable", False: ", unstable", None: ""}
MOST = 10  # largest number of unresolved stretches of one branch in a list


@dataclass
class Attractor:
    """An attractor at one parameter value.

    Attributes
    ----------
    value : float
        Parameter value.
    word : str
        Word of the motion; empty if it has none.
    periods : int
        Number of forcing periods after which it recurs.
    kind : str
        ``periodic``, ``sliding``, ``stuck``, ``chatter``, ``chaotic``, ``quasi-periodic``, ``slow``, ``escaped``, ``stopped`` or
        ``impossible`` (the start lies inside a wall).
    branch : str or None
        Label of the branch on which it lies.
    share : float
        Share of the starts that reach it or its mirror image.
    mirror_share : float
        Share of the starts that reach the mirror image of the motion found first.
    starts : int
        Number of starts simulated at this value. 0 if another motion was followed here past the end of its stability; there is no share then.
    exponent, error : float
        Largest Lyapunov exponent per period and its standard error, if the motion does not recur.
    """

    value: float
    word: str
    periods: int
    kind: str
    branch: str | None
    share: float
    mirror_share: float = 0.0
    starts: int = 0
    exponent: float = float("nan")
    error: float = float("nan")

    @property
    def name(self) -> str:
        """Displayed name: the word, or without one the kind of motion."""
        return called(self.word, self.kind)

    def to_dict(self) -> dict[str, Any]:
        """Return the entry in the JSON of a graph."""
        return asdict(self)


def sentences(stretches: Sequence[Unresolved], parameter: str) -> list[str]:
    """Return a sentence for each stretch; for branches with many, the first ones and the number of the others."""
    lines, counts = list[str](), Counter[str]()
    for stretch in stretches:
        counts[stretch.branch] += 1
        if counts[stretch.branch] <= MOST:
            lines.append(stretch.sentence(parameter))
    more = ((branch, count - MOST) for branch, count in counts.items() if count > MOST)
    return [
        *lines,
        *(
            f"unresolved on {branch}: {count} more stretches (graph.unresolved lists all)"
            for branch, count in more
        ),
    ]


@dataclass(frozen=True)
class Unresolved:
    """An unresolved stretch of a branch, with the counts of multipliers on both sides.

    Attributes
    ----------
    branch : str
        Label of the branch.
    low, high : float
        Parameter values of the two sides, in increasing order.
    index : int
        Index of the branch's point inside the stretch.
    reason : str
        * "multipliers": the numbers of multipliers outside the circle change by more than the points found between explain.
        * "determinant": the sign of the determinant changes without a branch point, for example because the two sides lie on different branches.
        * "neighbours": two special points are equal within their errors.
        * "parts": one of the first two, on a stretch that may be long, which was not searched further because `Settings.parts` was reached.
    before, after : (int, int, int)
        Numbers of multipliers past +1, past -1, and of complex pairs outside the circle on the two sides, in the branch's order.
    points : tuple of str
        Labels of the special points of "neighbours".
    """

    branch: str
    low: float
    high: float
    index: int
    reason: str
    before: tuple[int, int, int] = (0, 0, 0)
    after: tuple[int, int, int] = (0, 0, 0)
    points: tuple[str, ...] = ()

    def sentence(self, parameter: str) -> str:
        """Return the stretch as a sentence."""
        width = number_text(self.high - self.low, 2)
        place = (
            f"{self.branch} at {parameter} = {number_text(0.5 * (self.low + self.high), 12)}, {width} wide"
        )
        if self.reason == "neighbours":
            return f"unresolved on {place}: {' and '.join(self.points)} cannot be distinguished"
        if self.reason == "parts":
            return f"unresolved on {place}: not searched further, as this branch has used up settings.parts; raise it to search further"
        if self.reason == "determinant":
            return f"unresolved on {place}: a branch point, or two branches nearer than that"
        counts = (
            f"{sum(numbers[:2]) + 2 * numbers[2]} multiplier{'s' if sum(numbers) != 1 else ''} past the circle"
            for numbers in (self.before, self.after)
        )
        return f"unresolved on {place}: " + " before, ".join(counts) + " behind"

    def to_dict(self) -> dict[str, Any]:
        """Return the entry in the JSON of a graph."""
        return {name: list(v) if isinstance(v, tuple) else v for name, v in asdict(self).items()}

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> Unresolved:
        """Rebuild a stretch from the result of `to_dict`."""
        found: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in content.items()}
        return cls(**found)


class Proved(Protocol):
    """Protocol of a graph with proofs: claims and certificates by label."""

    @property
    def branches(self) -> Mapping[str, Branch]: ...
    @property
    def proofs(self) -> Mapping[str, Mapping[str, Any]]: ...


def proved_stretches(graph: Proved, label: str) -> list[tuple[list[int], dict[str, Any]]]:
    """Return the proved stretches of a branch: indices of its points on each, and the claims."""
    branch, found = graph.branches[label], []
    for stretch in graph.proofs.get(label, {}).get("stretches", ()):
        if stretch["covered"] is not None and stretch["real"] is not None:
            first, last = stretch["between"]
            low, high = (
                value * (1 + side * Settings.located) for side, value in zip((-1, 1), stretch["covered"])
            )
            points = [i for i in range(first, last + 1) if low <= branch.values[i] <= high]
            found.append((points, stretch))
    return found


def proof_text(graph: Proved, label: str) -> str:
    """Return the proved stretches of a branch as text."""
    return ", ".join(
        f"{low:.6g}..{high:.6g} {'real' if claim['real'] else 'virtual'}{STABLE[claim['stable']]}"
        for _, claim in proved_stretches(graph, label)
        for low, high in [claim["covered"]]
    )


def proof_mark(graph: Proved, label: str) -> str:
    """Return the mark of a label in tables and pictures: "proved", "proved virtual" or empty."""
    proof = graph.proofs.get(label)
    if not proof or not proof["existence"] or proof["real"] is None:
        return ""
    return "proved" if proof["real"] else "proved virtual"
