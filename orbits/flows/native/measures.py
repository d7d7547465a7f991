"""Measures of orbits: velocities at the impacts, losses per period, and what each machine adds of its own.

Everything is computed for many solutions at once: nodes have shape (m, L, n), parameter vectors (m, P), results (m,).
Energies are in units of m b^2 omega_0^2 (m the absorber's mass) per period of the orbit, which has k periods of the
forcing: a doubled orbit loses twice as much in it. Those that end in ``_mean`` are per forcing period, so that orbits of
different periods compare (and branches of doubled orbits begin where they leave).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contvines.shared.near_names import did_you_mean
from orbits.machines.base import Model
from orbits.machines.events import EventTable as EventTable
from orbits.machines.events import contacts, event_table
from orbits.machines.measures import ANGLES as ANGLES
from orbits.machines.measures import COMMON, KINDS, LOADS, MEANS, names, way_out
from orbits.words import Word


def measure(
    model: Model, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray, wanted: Sequence[str]
) -> dict[str, np.ndarray]:
    """`dimensionless`, in the units of a machine that has some."""
    return gauged(model, params, dimensionless(model, word, periods, nodes, params, wanted))


def gauged(model: Model, params: np.ndarray, found: dict[str, Any]) -> dict[str, Any]:
    """Dimensionless measures by name, in the machine's units; params (..., P), measures (...)."""
    return {name: value * model.gauge(KINDS.get(name, ""), params) for name, value in found.items()}


def dimensionless(
    model: Model, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray, wanted: Sequence[str]
) -> dict[str, np.ndarray]:
    """The measures `wanted` of many orbits with one word, in the machine's own numbers.

    ``B_post`` and ``B_pre`` are the absorber's absolute velocities after and before the first impact, each counted positive
    in its own usual direction (away from the wall, towards it), ``B`` is their mean (Youssef, Karoui, Leine: B = (B+ +
    B-)/2) and ``B_mean`` the mean of B over all impacts. ``C2`` is the squared amplitude of v, ``phase`` the
    forcing phase of the first event. ``impact_speed`` is the fastest approach. ``impact_loss`` is the kinetic energy of
    the relative motion lost at impacts, sum of (1 - r^2) w'-^2 / (2 (1 + eps)), ``friction_loss`` is mu g times the
    path slid; both over the orbit's period, ``impact_loss_mean`` and ``friction_loss_mean`` per forcing period.

    Loads, in units of m, b and omega_0: ``impact_rate`` is the number of impacts per unit of time; ``impulse`` the largest
    impulse of an impact, (1 + r) |w'-| / (1 + eps), ``impulse_left`` and ``impulse_right`` the largest at that wall (0 where
    there is no impact); ``impact_energy`` the kinetic energy of the relative motion before the hardest impact,
    w'-^2 / (2 (1 + eps)); ``mean_force`` the sum of all impulses over the period's time, the mean of the force's size;
    ``work_rate`` what impacts and friction take per unit of time; ``peak_force`` of the hardest impact, if its force is half a sine
    over the machine's contact time T: impulse = integral of F sin(pi t / T) = 2 F T / pi.

    Raises
    ------
    KeyError
        If a name is unknown.
    """
    known = names(model)
    for name in wanted:
        if name not in known:
            raise KeyError(
                f"measure {name!r} is unknown{way_out(name) or did_you_mean(name, known)}; choose one of {', '.join(known)}"
            )
    if not len(word):
        return {name: _at_rest(model, name, params) for name in wanted}
    m = nodes.shape[0]
    table = event_table(model, word, nodes, params)
    hits = np.array([letter in "LR" for letter in word.events])
    away = np.array([1.0 if letter == "L" else -1.0 for letter in word.events])[hits]
    nothing = np.full(m, np.nan)
    result: dict[str, np.ndarray] = {}
    means = [name for name in wanted if name in MEANS]
    if means:
        whole = dimensionless(model, word, periods, nodes, params, [MEANS[name] for name in means])
        result |= {name: whole[MEANS[name]] / periods for name in means}
    own = [name for name in wanted if name not in MEANS and (name not in COMMON or name == "C2")]
    if own and model.moving_cavity:
        from orbits.flows.native.driven_measures import own_measures

        result |= own_measures(own, model, word, periods, nodes, params)
    elif own:
        result["C2"] = np.asarray(model.column(params, model.driven_by)) ** 2
    for name in wanted:
        if name in result:
            continue
        if name == "phase":
            result[name] = np.mod(table.phase[:, 0], 2.0 * np.pi)
        elif name == "max_abs_w":
            result[name] = np.abs(table.w).max(axis=1)
        elif name == "friction_loss":
            steps = np.diff(np.concatenate([table.w, table.w[:, :1]], axis=1), axis=1)
            result[name] = model.friction_loss(steps, params)
        elif name == "impact_loss":
            r = contacts(model, word, params)[2]
            loss = np.where(hits, model.impact_loss(r, table.rate_pre, params), 0.0)
            result[name] = loss.sum(axis=1)
        elif name == "work_rate":
            lost = dimensionless(model, word, periods, nodes, params, ["impact_loss", "friction_loss"])
            result[name] = (lost["impact_loss"] + lost["friction_loss"]) / _duration(model, periods, params)
        elif name in LOADS:
            result[name] = _load(name, model, word, periods, params, table.rate_pre)
        elif not hits.any():
            result[name] = nothing if not name.startswith("impact_speed") else np.zeros(m)
        else:
            post, pre = table.B_post[:, hits] * away, -table.B_pre[:, hits] * away
            speed = np.abs(table.rate_pre[:, hits])
            result[name] = {
                "B": 0.5 * (post[:, 0] + pre[:, 0]),
                "B_post": post[:, 0],
                "B_pre": pre[:, 0],
                "B_mean": 0.5 * (post + pre).mean(axis=1),
                "impact_speed": speed.max(axis=1),
                "impact_speed_min": speed.min(axis=1),
            }[name]
    return result


def _duration(model: Model, periods: int, params: np.ndarray) -> np.ndarray:
    """Duration of the orbit in the machine's own time, shape (m,)."""
    return 2.0 * np.pi * periods / np.asarray(model.phase_speed(params))


def _load(
    name: str, model: Model, word: Word, periods: int, params: np.ndarray, rates: np.ndarray
) -> np.ndarray:
    """A measure of the forces at the walls, from the relative speeds before the events, shape (m, L)."""
    hits, _, restitution = contacts(model, word, params)
    duration = _duration(model, periods, params)
    if name == "impact_rate":
        return hits.sum() / duration
    # without restitution an impact takes all energy of the relative motion: half the reduced mass times the speed squared
    energy = np.where(hits, model.impact_loss(np.zeros_like(rates), rates, params), 0.0)
    if name == "impact_energy":
        return energy.max(axis=1)
    reduced = 2.0 * model.impact_loss(np.zeros_like(rates), np.ones_like(rates), params)
    impulses = np.where(hits, reduced * (1.0 + restitution) * np.abs(rates), 0.0)
    if name == "mean_force":
        return impulses.sum(axis=1) / duration
    if name == "peak_force":
        assert model.contact_time is not None
        return impulses.max(axis=1) * np.pi / (2.0 * model.contact_time * model.gauge("rate", params))
    if name != "impulse":
        letter = "L" if name == "impulse_left" else "R"
        impulses = np.where([event == letter for event in word.events], impulses, 0.0)
    return impulses.max(axis=1)


def _at_rest(model: Model, name: str, params: np.ndarray) -> np.ndarray:
    """A measure of the absorber at rest; velocities at impacts are not a number."""
    name = MEANS.get(name, name)  # its period is the forcing's
    if name in (
        *LOADS,
        "work_rate",
        "impact_loss",
        "friction_loss",
        "impact_speed",
        "impact_speed_min",
        "max_abs_w",
    ):
        return np.zeros(len(params))
    rest = model.rest
    return np.array([rest.measure(name, row, rest.solved(row)) for row in params])
