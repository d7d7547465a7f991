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
        factor is positive; a negative one rejects this step, which is tried again with the length ``-factor`` (below 1). It gets

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
