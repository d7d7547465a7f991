"""Ending: why a branch ends, as data; the sentence is made last."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

from ..continuation.layout import Status
from ..shared.number_text import number_text


class Reason(StrEnum):
    """Why a branch ends; the first ones are those of the continuation loop (:class:`contvines.continuation.layout.Status`)."""

    RUNNING = "running"
    LEFT_INTERVAL = "left-interval"
    STEP_TOO_SMALL = "step-too-small"
    NOT_EVALUABLE = "not-evaluable"
    BORDER = "border"
    MAX_POINTS = "max-points"
    CLOSED = "closed"
    ESCAPED = "escaped"
    CREEPING = "creeping"
    COARSE = "coarse"
    LEAVES = "leaves"
    GOES_ON = "goes-on"
    REACHES = "reaches"
    MEETS = "meets"
    MEETS_SYMMETRIC = "meets-symmetric"
    COMES_BACK = "comes-back"
    STOPS = "stops"
    SAID = "said"


@dataclass(frozen=True)
class Ending:
    """One end of a branch.

    Attributes
    ----------
    reason : Reason
    value : float
        Parameter value there.
    point : str or None
        Label of the special point there.
    other : str or None
        Label of the other branch: the one that is left, gone on from or met.
    kind : str or None
        Kind of the special point as this branch sees it.
    text : str
        What the problem says of it; for SAID the whole sentence, of a file of version 0.1 or of something that is no branch.
    """

    reason: Reason
    value: float = float("nan")
    point: str | None = None
    other: str | None = None
    kind: str | None = None
    text: str = ""

    @classmethod
    def of(cls, status: Status, value: float) -> Ending:
        """The ending by which the continuation loop stopped."""
        return cls(Reason[status.name], float(value))

    @classmethod
    def said(cls, text: str) -> Ending:
        """An ending of which only a sentence is known."""
        return cls(Reason.SAID, text=text)

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> Ending:
        """What `to_dict` made."""
        return cls(**{**content, "reason": Reason(content["reason"])})

    def to_dict(self) -> dict[str, Any]:
        """As JSON scalars."""
        return {**asdict(self), "reason": self.reason.value}

    def sentence(self, parameter: str, unit: float = 1.0) -> str:
        """The ending for people; ``unit`` is the size of the parameter, beside which rounding is zero."""
        at = f"{parameter} = {number_text(self.value, 10, unit)}"
        match self.reason:
            case Reason.SAID:
                return self.text
            case Reason.LEAVES:
                return f"leaves {self.other} at {self.point}"
            case Reason.GOES_ON:
                return f"goes on from {self.other} at {self.point}"
            case Reason.REACHES:
                return f"reaches {self.point} ({self.kind}) at {at}"
            case Reason.STOPS:
                return f"stops at {self.point} ({self.text}), {at}"
            case Reason.MEETS:
                return f"meets {self.other} at {self.point} ({self.kind}), {at}"
            case Reason.MEETS_SYMMETRIC:
                return f"meets {self.other} at {self.point}, {at}"
            case Reason.COMES_BACK:
                return f"comes back to more symmetric solutions at {self.point}, {at}"
        said = Status[self.reason.name].sentence(parameter, self.value, unit)
        return f"{said}; {self.text}" if self.text else said
