"""Measures of orbits: velocities at the impacts, losses per period, and what each machine adds of its own.

Everything is computed for many solutions at once: nodes have shape (m, L, n), parameter vectors (m, P), results (m,).
Energies are in units of m b^2 omega_0^2 (m the absorber's mass) per period of the orbit, which has k periods of the
forcing: a doubled orbit loses twice as much in it. Those that end in ``_mean`` are per forcing period, so that orbits of
different periods compare (and branches of doubled orbits begin where they leave).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from orbits.machines.base import Model
from orbits.words import Word

COMMON = (
    "B",
    "B_post",
    "B_pre",
    "B_mean",
    "C2",
    "phase",
    "impact_speed",
    "impact_speed_min",
    "impact_loss",
    "friction_loss",
    "max_abs_w",
)

ANGLES = ("phase", "v_phase")  # radians, modulo 2 pi
ENERGIES = (  # per period of the orbit
    "impact_loss",
    "friction_loss",
    "input_work",
    "damping_loss",
    "force_work",
    "grounded_damping_loss",
)
MEANS = {f"{name}_mean": name for name in ENERGIES}  # per forcing period


@dataclass(frozen=True)
class EventTable:
    """What happens at each event; all arrays have shape (m, L).

    Attributes
    ----------
    phase : float array
        Psi, radians from the start of the forcing.
    w, rate_post, rate_pre : float array
        Relative position, relative velocity after and before the event.
    B_post, B_pre : float array
        Absolute velocity of the absorber times 1 + eps, v' - w', after and before the event.
    v, v_rate : float array
        Cavity coordinate v and its rate.
    """

    phase: np.ndarray
    w: np.ndarray
    rate_post: np.ndarray
    rate_pre: np.ndarray
    B_post: np.ndarray
    B_pre: np.ndarray
    v: np.ndarray
    v_rate: np.ndarray


KINDS = {
    "B": "velocity",
    "B_post": "velocity",
    "B_pre": "velocity",
    "B_mean": "velocity",
    "C2": "area",
    "phase": "angle",
    "impact_speed": "velocity",
    "impact_speed_min": "velocity",
    "max_abs_w": "length",
    "max_abs_q1": "length",
    "amplitude": "length",
    "v_phase": "angle",
    **dict.fromkeys((*ENERGIES, *MEANS), "energy"),
}
"""What kind of quantity each measure is, where it is more than a number."""


def parameter(model: Model, params: np.ndarray, name: str) -> np.ndarray:
    """Column `name` of the parameter vectors, shape (m, 1)."""
    return params[:, model.parameter_names.index(name)][:, None]


def event_table(model: Model, word: Word, nodes: np.ndarray, params: np.ndarray) -> EventTable:
    """Positions and velocities at all events, from nodes (m, L, n) and parameter vectors (m, P)."""
    phase = nodes[:, :, 0]
    v, v_rate = model.cavity_motion(nodes, params)
    hits, walls, r = contacts(model, word, params)
    w = np.where(hits, walls, nodes[:, :, 1])
    rate_post = np.where(hits, v_rate - nodes[:, :, 1], 0.0)
    rate_pre = np.where(hits, -rate_post / r, 0.0)
    return EventTable(phase, w, rate_post, rate_pre, v_rate - rate_post, v_rate - rate_pre, v, v_rate)


def contacts(model: Model, word: Word, params: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which events are impacts, shape (L,), and their walls' places and coefficients of restitution, shape (m, L)."""
    left = np.array([letter == "L" for letter in word.events], dtype=bool)
    hits = left | np.array([letter == "R" for letter in word.events], dtype=bool)
    (at_left, at_right), (by_left, by_right) = model.walls(params), model.restitutions(params)
    walls = np.where(left, at_left[:, None], at_right[:, None])
    return hits, walls, np.where(left, by_left[:, None], by_right[:, None])


def names(model: Model) -> tuple[str, ...]:
    """Measures that orbits of this machine have."""
    known = COMMON + model.own_measures
    return known + tuple(mean for mean, name in MEANS.items() if name in known)


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

    Raises
    ------
    KeyError
        If a name is unknown.
    """
    known = names(model)
    for name in wanted:
        if name not in known:
            raise KeyError(f"measure {name!r} is unknown; choose one of {', '.join(known)}")
    m = nodes.shape[0]
    table = event_table(model, word, nodes, params)
    hits = np.array([letter in "LR" for letter in word.events])
    away = np.array([1.0 if letter == "L" else -1.0 for letter in word.events])[hits]
    eps = parameter(model, params, "mass_ratio")
    nothing = np.full(m, np.nan)
    result: dict[str, np.ndarray] = {}
    means = [name for name in wanted if name in MEANS]
    if means:
        whole = dimensionless(model, word, periods, nodes, params, [MEANS[name] for name in means])
        result |= {name: whole[MEANS[name]] / periods for name in means}
    own = [name for name in wanted if name not in MEANS and (name not in COMMON or name == "C2")]
    if own:
        result |= model.measure_own(own, word, periods, nodes, params)
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
            loss = np.where(hits, (1.0 - r**2) * table.rate_pre**2 / (2.0 * (1.0 + eps)), 0.0)
            result[name] = loss.sum(axis=1)
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
