"""Why a branch ended, in words."""

from __future__ import annotations

from enum import IntEnum

from ..shared.number_text import number_text


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
    CREEPING = 8
    COARSE = 9

    def sentence(self, parameter: str = "p", value: float = float("nan"), unit: float = 1.0) -> str:
        """The status as a sentence about a branch at this parameter value; beside ``unit`` rounding is zero."""
        long, short = number_text(value, 10, unit), number_text(value, 6, unit)
        return {
            Status.RUNNING: "unfinished",
            Status.LEFT_INTERVAL: f"reaches the end of the interval, {parameter} = {short}",
            Status.STEP_TOO_SMALL: f"no convergence near {parameter} = {long}, even with the smallest step",
            Status.NOT_EVALUABLE: f"the equations cannot be evaluated beyond {parameter} = {long}",
            Status.BORDER: f"reaches a border at {parameter} = {long}",
            Status.MAX_POINTS: f"the largest number of points is reached at {parameter} = {short}",
            Status.ESCAPED: f"the unknowns run away near {parameter} = {short}",
            Status.CREEPING: f"creeps near {parameter} = {long}: very many points with next to no progress",
            Status.COARSE: f"the mesh is too coarse beyond {parameter} = {long}",
            Status.CLOSED: "closed: the branch returns to its start",
        }[self]
