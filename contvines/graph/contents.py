"""What a graph holds beside branches, special points and switches: attractors that simulation has met, proofs, and stretches that are not resolved.

A stretch of a branch is not resolved where its two ends do not agree with the special points found between them.
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
MOST = 10  # stretches of one branch that are listed


@dataclass
class Attractor:
    """One attractor at one value.

    Attributes
    ----------
    value : float
    word : str
    periods : int
    kind : str
        ``periodic``, ``sliding``, ``stuck``, ``chatter``, ``chaotic``, ``quasi-periodic``, ``slow``, ``escaped``, ``stopped`` or
        ``impossible`` (the start lies inside a wall).
    branch : str or None
        Label of the branch on which it lies.
    share : float
        Of the starts that reach it or its mirror image.
    mirror_share : float
        Of the starts that reach the image other than the one found first.
    starts : int
        How many were simulated at this value; 0 where another motion was followed here past the end of its stability, so that it has no share.
    exponent, error : float
        Largest Lyapunov exponent per period and its standard error, where it does not recur.
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
        """Name that is shown: its word, or what kind of motion has none."""
        return called(self.word, self.kind)

    def to_dict(self) -> dict[str, Any]:
        """The entry in the JSON of a graph."""
        return asdict(self)


def sentences(stretches: Sequence[Unresolved], parameter: str) -> list[str]:
    """For people: each stretch; of branches with many the first ones, and how many more there are."""
    lines, seen = list[str](), Counter[str]()
    for stretch in stretches:
        seen[stretch.branch] += 1
        if seen[stretch.branch] <= MOST:
            lines.append(stretch.sentence(parameter))
    more = ((branch, count - MOST) for branch, count in seen.items() if count > MOST)
    return [
        *lines,
        *(
            f"unresolved on {branch}: {count} more stretches (graph.unresolved lists all)"
            for branch, count in more
        ),
    ]


@dataclass(frozen=True)
class Unresolved:
    """What is certain on both sides of a stretch that is not halved any more.

    Attributes
    ----------
    branch : str
        Label of the branch.
    low, high : float
        Parameter values of the two sides, in increasing order.
    index : int
        Of the point of the branch that lies within.
    reason : str
        "multipliers": their numbers past the circle change by more than the points between say; "determinant": its sign changes without
        a branch point, as where the two sides lie on different branches; "neighbours": two special points are one as far as they are known;
        "parts": one of the first two, of a stretch that may be long: it was not searched as closely as others, for `Settings.parts` were spent.
    before, after : (int, int, int)
        Numbers of multipliers past +1, past -1, and of complex pairs past the circle on the two sides, in the branch's order.
    points : tuple of str
        Labels of special points there.
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
        """For people."""
        width = number_text(self.high - self.low, 2)
        where = (
            f"{self.branch} at {parameter} = {number_text(0.5 * (self.low + self.high), 12)}, {width} wide"
        )
        if self.reason == "neighbours":
            return f"unresolved on {where}: {' and '.join(self.points)} cannot be distinguished"
        if self.reason == "parts":
            return f"unresolved on {where}: not searched any closer, settings.parts of this branch are spent; raise them to search on"
        if self.reason == "determinant":
            return f"unresolved on {where}: a branch point, or two branches nearer than that"
        counts = (
            f"{sum(numbers[:2]) + 2 * numbers[2]} multiplier{'s' if sum(numbers) != 1 else ''} past the circle"
            for numbers in (self.before, self.after)
        )
        return f"unresolved on {where}: " + " before, ".join(counts) + " behind"

    def to_dict(self) -> dict[str, Any]:
        """The entry in the JSON of a graph."""
        return {name: list(v) if isinstance(v, tuple) else v for name, v in asdict(self).items()}

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> Unresolved:
        """What `to_dict` made."""
        found: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in content.items()}
        return cls(**found)


class Proved(Protocol):
    """A graph with the claims and certificates of what is proved, by label."""

    @property
    def branches(self) -> Mapping[str, Branch]: ...
    @property
    def proofs(self) -> Mapping[str, Mapping[str, Any]]: ...


def proved_stretches(graph: Proved, label: str) -> list[tuple[list[int], dict[str, Any]]]:
    """The proved stretches of a branch: the numbers of its points on each, and what is proved of them."""
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
    """The proved stretches of a branch in words."""
    return ", ".join(
        f"{low:.6g}..{high:.6g} {'real' if about['real'] else 'virtual'}{STABLE[about['stable']]}"
        for _, about in proved_stretches(graph, label)
        for low, high in [about["covered"]]
    )


def proof_mark(graph: Proved, label: str) -> str:
    """How tables and pictures mark a label: "proved", "proved virtual" or nothing."""
    proof = graph.proofs.get(label)
    if not proof or not proof["existence"] or proof["real"] is None:
        return ""
    return "proved" if proof["real"] else "proved virtual"
