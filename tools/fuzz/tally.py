"""Counts of checks, and findings."""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple


class Finding(NamedTuple):
    """A result that seems wrong: machine, check, and text with the place."""

    kind: str
    salt: int
    seed: int
    check: str
    text: str

    def __str__(self) -> str:
        return f"{self.kind} {self.seed} (salt {self.salt})  {self.check}: {self.text}"


class Tally:
    """Counts and findings of one machine, or of many."""

    def __init__(self, kind: str = "", salt: int = 0, seed: int = 0) -> None:
        self.kind, self.salt, self.seed = kind, salt, seed
        self.counts: Counter[str] = Counter()
        self.findings: list[Finding] = []

    def count(self, what: str, times: int = 1) -> None:
        """Add to the count of a check."""
        self.counts[what] += times

    def find(self, check: str, text: str) -> None:
        """Add a finding."""
        self.findings.append(Finding(self.kind, self.salt, self.seed, check, text))

    def add(self, other: Tally) -> None:
        """Add the counts and findings of another machine."""
        self.counts += other.counts
        self.findings += other.findings

    def table(self) -> str:
        """Return the counts as text, one per line."""
        width = max(map(len, self.counts), default=0)
        return "\n".join(f"{what:<{width}}  {times}" for what, times in sorted(self.counts.items()))
