"""Why a branch ended, in words."""

from __future__ import annotations

from enum import IntEnum


class Status(IntEnum):
    """Status codes of the continuation loop; ``sentence`` says what they mean."""

    RUNNING = 0
    LEFT_INTERVAL = 1
    STEP_TOO_SMALL = 2
    NOT_EVALUABLE = 3
    BORDER = 4
    MAX_POINTS = 5
    CLOSED = 6
    ESCAPED = 7

    def sentence(self, parameter: str = "p", value: float = float("nan")) -> str:
        """The status as a sentence about a branch at this parameter value."""
        return {
            Status.RUNNING: "unfinished",
            Status.LEFT_INTERVAL: f"reaches the end of the interval, {parameter} = {value:.6g}",
            Status.STEP_TOO_SMALL: f"no convergence near {parameter} = {value:.10g}, even with the smallest step",
            Status.NOT_EVALUABLE: f"the equations cannot be evaluated beyond {parameter} = {value:.10g}",
            Status.BORDER: f"reaches a border at {parameter} = {value:.10g}",
            Status.MAX_POINTS: f"the largest number of points is reached at {parameter} = {value:.6g}",
            Status.ESCAPED: f"the unknowns run away near {parameter} = {value:.6g}",
            Status.CLOSED: "closed: the branch returns to its start",
        }[self]
