"""Step rules: whether a step along a branch is accepted, and how long the next one is.

The continuation loop asks a rule after every step that the corrector has brought back to the branch; a step that the corrector gives up
is halved without asking. The rule by angle has a native twin (native/march.hpp); another one is called once a step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class StepRule:
    """A rule for the length of steps.

    Parameters
    ----------
    judge : callable
        ``judge(turn, error, sweeps, length, angle, roundoff) -> factor``. The next step is `factor` times as long as this one if the
        factor is positive; a negative one, above -1, rejects this step, which is tried again ``-factor`` times as long. It gets

        ``turn``
            the angle between the tangents before and after the step, radians;
        ``error``
            the distance of the corrected point from the predicted one;
        ``sweeps``
            how many Newton corrections that took;
        ``length``
            the length of the step, in the metric of the run (`contvines.Settings`);
        ``angle``
            the angle to aim at, from the settings;
        ``roundoff``
            the distance below which errors mean nothing.

    name : str
        What a graph's settings call it.
    """

    judge: Callable[..., float]
    name: str

    def __post_init__(self) -> None:
        if not callable(self.judge):
            raise ValueError(
                f"step_rule: judge = {self.judge!r} must be a function of (turn, error, sweeps, length, angle, roundoff)"
            )
        if not isinstance(self.name, str):
            raise ValueError(f"step_rule: name = {self.name!r} must be a text")

    def factor(self, *numbers: float) -> float:
        """What ``judge`` says of a step.

        Raises
        ------
        ValueError
            If it returns no such factor.
        """
        found = self.judge(*numbers)
        try:
            factor = float(found)
        except (TypeError, ValueError):
            factor = 0.0
        if not (factor > 0.0 or -1.0 < factor < 0.0):
            raise ValueError(
                f"step_rule {self.name!r}: judge returned {found!r} for a step of length {numbers[3]:.3g}; a factor is asked for, "
                "above 0 for the next step, or between -1 and 0 to try this one again"
            )
        return factor


def by_angle(turn, error, sweeps, length, angle, roundoff):
    """Aim at an angle between neighbouring tangents (as COCO does).

    An angle beyond twice of it, or a predictor error beyond the angle times the step, rejects the step.
    """
    if not (turn <= 2.0 * angle and error <= angle * length + roundoff):
        return -0.5
    factor = 2.0
    if turn > 0.5 * angle:
        factor = max(0.5, angle / turn)
    if sweeps > 3:
        factor = min(factor, 0.8)
    return factor


BY_ANGLE = StepRule(by_angle, "angle")
