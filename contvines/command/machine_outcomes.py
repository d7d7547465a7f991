"""Outcomes of a survey that only machines have: what impacts and friction dissipate, and how fast a free motion decays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.orbit import Orbit

if TYPE_CHECKING:
    from contvines.survey.outcomes import Findings, Outcome


def dissipation(found: Findings) -> dict[str, float]:
    """Power that impacts and friction dissipate where the stable response of the diagram is largest; nan of a declared machine without ``energy=``."""
    from contvines.survey.outcomes import highest, stretches

    top = highest(stretches(found.graph))
    if top is None or "impact_loss" not in top.stretch.branch.measure_names:
        return {"impact_power": np.nan, "friction_power": np.nan}
    orbit = top.stretch.branch.orbit(top.place)
    assert isinstance(orbit, Orbit)
    seconds = orbit.period * float(orbit.model.gauge("time", orbit.params))
    share = seconds * (0.001 if orbit.model.units.get("impact_loss") == "J" else 1.0)  # shown in mW
    return {f"{name}_power": orbit.measure(f"{name}_loss") / share for name in ("impact", "friction")}


def pumping(found: Findings) -> dict[str, float]:
    """How long a free decay takes to lose nine tenths of its energy, and the absorber's share of what is lost.

    It starts from the displacement that is the largest of the stable responses of the diagram, the absorber at rest in the middle.
    """
    from contvines.survey.outcomes import peak
    from orbits.design.transients import free_decay
    from orbits.machines.base import Model

    seed = found.seed
    assert isinstance(seed, Orbit)
    model = seed.model
    assert isinstance(model, Model)
    height = peak(found)["peak"] / float(model.gauge("length", seed.params))
    if not np.isfinite(height):
        return {"pumping_time": np.nan, "pumped_share": np.nan}
    decay = free_decay(model, seed.params, height)
    return {
        "pumping_time": decay.pumping_time * float(model.gauge("time", seed.params)),
        "pumped_share": decay.absorber_share,
    }


OWN: dict[str, Outcome] = {"dissipation": dissipation, "pumping": pumping}
UNITS = {"impact_power": "mW", "friction_power": "mW", "pumping_time": "s"}
