"""Reasons for a failed proof as data: the step, the event and a remedy; their text is made last."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any


class ProofError(ValueError):
    """A proof cannot begin; the message gives the reason and a way out."""


class Step(Enum):
    """A step of a proof; the value is its text."""

    REFINEMENT = "Newton's method at high precision"
    EXISTENCE = "existence"
    ADMISSIBILITY = "admissibility"
    STABILITY = "stability"
    PIECE = "the piece of the branch"


class Remedy(Enum):
    """A remedy for a failed step; the value is its text."""

    BITS = "more bits would help (bits=...)"
    START = "nodes nearer to an orbit would help: solve for the orbit first"
    DEGENERATE = "the point is degenerate for its kind: its defining system is singular here"
    SMALLER = "smaller steps or parameter balls would help"
    BORDER = "the orbit lies on a border, where neither sign can be proved"
    CIRCLE = "a multiplier lies on the unit circle, or too near to it to tell"
    SYMMETRIC = "an impact-free motion is proved where it is symmetric, on half its word"
    OTHER_WORD = "the word of the branch on the other side of this border would help"


@dataclass(eq=False)
class Obstacle(Exception):
    """A failed step of a proof: the step, a remedy, the event at which it failed (if it has one), and details."""

    step: Step
    remedy: Remedy
    event: int | None = None
    detail: str = ""

    def __str__(self) -> str:
        at = "" if self.event is None else f" at event {self.event}"
        reason = f" ({self.detail})" if self.detail else ""
        return f"{self.step.value}{at} was not proved{reason}; {self.remedy.value}"

    def to_dict(self) -> dict[str, Any]:
        """Return the obstacle as a dict for JSON."""
        return {
            "step": self.step.name.lower(),
            "remedy": self.remedy.name.lower(),
            "event": self.event,
            "detail": self.detail,
            "text": str(self),
        }
