"""A first clearance by theory, before any motion is solved for: multiple scales without friction, and what the calm absorber does."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from orbits.theory.multiple_scales import SlowFlow, best_clearance

if TYPE_CHECKING:
    from orbits.machines.base import Model


@dataclass(frozen=True)
class FirstClearance:
    """Half-widths by theory, in the machine's units of length.

    Attributes
    ----------
    linear_peak : float
        Of the oscillator at resonance, the absorber held fast.
    widest : float
        The best half-width where the absorber is at work (`orbits.multiple_scales.best_clearance`): wider ones are not entered at resonance.
    remaining : float
        The oscillator's amplitude at resonance that is left there.
    entered : float
        Below this half-width the absorber cannot stay calm at resonance: the oscillator's linear peak moves the walls as far as an absorber
        that stands still in space.
    """

    linear_peak: float
    widest: float
    remaining: float
    entered: float

    @property
    def safe(self) -> float:
        """The half-width to begin with: the best one that is entered from every start."""
        return min(self.widest, self.entered)


def first_clearance(model: Model, params: np.ndarray) -> FirstClearance | None:
    """Half-widths by theory; None for a machine without an oscillator or damping, with an inclined cavity, or whose absorber loses nothing at the walls.

    With F/k = eps G and 2 D = eps lambda/sqrt(1 + eps) the linear peak is F/(2 D k) = G sqrt(1 + eps)/lambda half-widths; it does not
    depend on the half-width in lengths. Friction is left out.

    Parameters
    ----------
    model : Model
    params : float array (P,)
    """
    numbers = model.named(params)
    damping, forcing = numbers.get("damping", 0.0), numbers.get("forcing", 0.0)
    if numbers.get("slope", 0.0) != 0.0 or not (
        damping > 0.0 and forcing > 0.0 and 0.0 < numbers["restitution"] < 1.0
    ):
        return None
    eps = numbers["mass_ratio"]
    flow = SlowFlow(restitution=numbers["restitution"], friction=0.0, mass_ratio=eps, damping=damping)
    best = best_clearance(flow)
    peak = forcing * math.sqrt(1.0 + eps) / damping * float(model.gauge("length", params))
    return FirstClearance(peak, best.ratio * peak, best.reduction * peak, peak)
