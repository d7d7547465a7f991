"""Largest Lyapunov exponent of a declared machine's motion, from two neighbours that are drawn together again and again."""

from __future__ import annotations

import math

import numpy as np

from contvines.shared.motions import mean_of_blocks
from orbits.flows.page.stepper import TWO_PI, Stepper
from orbits.numbers import SMALLEST
from orbits.settings import SIMULATING

SAMPLES, BLOCKS = 1200, 20
PATIENCE, FORGET = 8, 50  # samples waited out; samples in which the neighbours forget how they were put down
EARLY, CLEAR = (
    4,
    8.0,
)  # a quarter of the samples are enough where the exponent is positive by so many standard errors


def growth(stepper: Stepper, samples: int = SAMPLES) -> tuple[float, float]:
    """Exponent per forcing period (of a self-excited machine: per event), and its standard error.

    After Benettin, Galgani, Giorgilli and Strelcyn (Meccanica 15 (1980) 9): the logarithm of how much the distance of two
    neighbours grows, averaged; the scatter of twenty blocks gives the error. Samples at which the neighbours are in different
    modes (one of them is past an event that the other still has before it) are waited out.

    Parameters
    ----------
    stepper : Stepper
        On the motion; it is moved on.
    samples : int
    """
    other = Stepper(stepper.machine, stepper.params)
    generator = np.random.default_rng(1)
    _beside(stepper, other, generator.standard_normal(len(stepper.state)))
    start = _distance(stepper, other)[1]
    logs: list[float] = []
    waited, tries = 1, 0
    while len(logs) < samples and tries < 4 * samples:
        tries += 1
        if len(logs) == samples // EARLY and tries > FORGET:
            exponent, error = mean_of_blocks(np.array(logs), BLOCKS)
            if exponent > CLEAR * error:  # certainly chaotic
                return exponent, error
        alike = _together(stepper, other)
        apart, size = _distance(stepper, other)
        if not alike and waited < PATIENCE and size < SIMULATING.far:
            waited += 1
            continue
        if alike and start > 0.0 and size > 0.0:
            if tries > FORGET:
                logs.append(math.log(size / start) / waited)
        else:
            apart = generator.standard_normal(len(stepper.state))
        _beside(stepper, other, apart)
        start = _distance(stepper, other)[1]
        waited = 1
    if len(logs) < BLOCKS:
        return math.nan, math.nan
    return mean_of_blocks(np.array(logs), BLOCKS)


def _beside(stepper: Stepper, other: Stepper, direction: np.ndarray) -> None:
    scale = SIMULATING.nudge * (1.0 + float(np.abs(stepper.state).max()))
    state = stepper.state + scale * direction / max(float(np.abs(direction).max()), SMALLEST)
    other.start(state, stepper.clock, stepper.modes)
    other.base = stepper.base


def _distance(stepper: Stepper, other: Stepper) -> tuple[np.ndarray, float]:
    apart = other.state - stepper.state
    return apart, float(np.abs(apart).max())


def _together(stepper: Stepper, other: Stepper) -> bool:
    """Move both on by a forcing period (or an event); whether they are then in the same modes."""
    if not stepper.machine.forced:
        event, image = (
            stepper.advance(stepper.base + SIMULATING.wait),
            other.advance(other.base + SIMULATING.wait),
        )
        return event == image and stepper.modes == other.modes
    until = stepper.base + stepper.clock + TWO_PI
    for each in (stepper, other):
        while each.advance(until) is not None:
            pass
    return stepper.modes == other.modes
