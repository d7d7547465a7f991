"""Measures of orbits of the built-in machines: velocities at impacts, losses per period, and measures of single machines.

All measures are computed for many solutions at once: nodes have shape (m, L, n), parameter vectors (m, P), results (m,).
Energies are in units of m b^2 omega_0^2 (m: mass of the absorber) per period of the orbit, which has k forcing periods: a doubled orbit
loses twice as much in its period. Names that end in ``_mean`` are per forcing period, so that orbits of different periods can be
compared, and a branch of doubled orbits begins at the value of its parent.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from contvines.shared.near_names import did_you_mean
from orbits.machines.base import Model
from orbits.machines.measures import ANGLES as ANGLES
from orbits.machines.measures import COMMON, KINDS, LOADS, MEANS, WITHOUT_IMPACTS, loads, way_out
from orbits.machines.native_stepper import stepper
from orbits.machines.varying import Varying
from orbits.words import Word
from orbits.words.alphabet import CODES


def measure(
    model: Model, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray, wanted: Sequence[str]
) -> dict[str, np.ndarray]:
    """Return measures by name, in the machine's units; see `dimensionless`."""
    return gauged(model, params, dimensionless(model, word, periods, nodes, params, wanted))


def gauged(model: Model, params: np.ndarray, values: dict[str, Any]) -> dict[str, Any]:
    """Convert dimensionless measures by name to the machine's units; params (..., P), measures (...)."""
    return {name: value * model.gauge(KINDS.get(name, ""), params) for name, value in values.items()}


def dimensionless(
    model: Model, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray, wanted: Sequence[str]
) -> dict[str, np.ndarray]:
    """Return the measures `wanted` of many orbits with one word, in the machine's dimensionless units.

    Velocities and energies:

    - ``B_post``, ``B_pre``: absolute velocity of the absorber (times 1 + eps) after and before the first impact, each positive in its usual
      direction (away from the wall, towards it); ``B`` is their mean (Youssef, Karoui, Leine: B = (B+ + B-)/2), ``B_mean`` the mean of B
      over all impacts.
    - ``C2``: squared amplitude of v. ``phase``: forcing phase of the first event. ``impact_speed``: fastest approach.
    - ``impact_loss``: kinetic energy of the relative motion lost at impacts, sum of (1 - r^2) w'-^2 / (2 (1 + eps)); ``friction_loss``:
      mu g times the sliding distance; both per period of the orbit, ``impact_loss_mean`` and ``friction_loss_mean`` per forcing period.

    Loads, in units of m, b and omega_0:

    - ``impact_rate``: impacts per unit of time.
    - ``impulse``: largest impulse of an impact, (1 + r) |w'-| / (1 + eps); ``impulse_left``, ``impulse_right``: largest at that wall (0
      without impacts there).
    - ``impact_energy``: kinetic energy of the relative motion before the hardest impact, w'-^2 / (2 (1 + eps)).
    - ``mean_force``: sum of all impulses over the period, the mean size of the contact force.
    - ``work_rate``: power lost in impacts and friction.
    - ``peak_force``: of the hardest impact, for a force of half a sine over the machine's contact time T: impulse = integral of
      F sin(pi t / T) = 2 F T / pi.

    Raises
    ------
    KeyError
        If a name is unknown.
    """
    available = model.measure_names
    for name in wanted:
        if name not in available:
            raise KeyError(
                f"measure {name!r} is unknown{way_out(name) or did_you_mean(name, available)}; choose one of {', '.join(available)}"
            )
    if not len(word):
        return {name: _at_rest(model, name, params) for name in wanted}
    m = nodes.shape[0]
    table = event_table(model, word, nodes, params)
    hits = np.array([letter in "LR" for letter in word.events])
    away = np.array([1.0 if letter == "L" else -1.0 for letter in word.events])[hits]
    result: dict[str, np.ndarray] = {}
    means = [name for name in wanted if name in MEANS]
    if means:
        whole = dimensionless(model, word, periods, nodes, params, [MEANS[name] for name in means])
        result |= {name: whole[MEANS[name]] / periods for name in means}
    basic = [name for name in wanted if name not in MEANS and (name not in COMMON or name == "C2")]
    if basic and model.moving_cavity:
        result |= own_measures(basic, model, word, periods, nodes, params)
    elif basic:
        result["C2"] = np.asarray(model.column(params, model.driven_by)) ** 2
    lasts = 2.0 * np.pi * periods / np.asarray(model.phase_speed(params))
    if not {*LOADS, "impact_loss"}.isdisjoint(wanted):
        held = None if model.contact_time is None else model.contact_time * model.gauge("rate", params)
        sides = ["left" if letter == "L" else "right" for letter in word.events if letter in "LR"]
        mass = 1.0 / (1.0 + np.asarray(model.column(params, "mass_ratio"))[:, None])
        r = contacts(model, word, params)[2][:, hits]
        result |= loads(np.abs(table.rate_pre[:, hits]), r, mass, sides, ("left", "right"), lasts, held)
    if not {"friction_loss", "work_rate"}.isdisjoint(wanted):
        steps = np.diff(np.concatenate([table.w, table.w[:, :1]], axis=1), axis=1)
        result["friction_loss"] = model.friction_loss(steps, params)
        if "work_rate" in wanted:
            result["work_rate"] = (result["impact_loss"] + result["friction_loss"]) / lasts
    for name in wanted:
        if name in result:
            continue
        if name == "phase":
            result[name] = np.mod(table.phase[:, 0], 2.0 * np.pi)
        elif name == "max_abs_w":
            result[name] = np.abs(table.w).max(axis=1)
        elif not hits.any():
            result[name] = np.zeros(m) if name in WITHOUT_IMPACTS else np.full(m, np.nan)
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
    return {name: result[name] for name in wanted}


def _at_rest(model: Model, name: str, params: np.ndarray) -> np.ndarray:
    """Return a measure of the absorber at rest; velocities at impacts are NaN."""
    name = MEANS.get(name, name)  # the period of rest is one forcing period
    if name in (*WITHOUT_IMPACTS, "friction_loss", "max_abs_w"):
        return np.zeros(len(params))
    rest = model.rest
    return np.array([rest.measure(name, row, rest.solved(row)) for row in params])


POWERS = ("input_work", "damping_loss", "force_work", "grounded_damping_loss")


def own_measures(
    wanted: Sequence[str], model: Model, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray
) -> dict[str, np.ndarray]:
    """Return measures of machines with an oscillator, for many orbits with one word; nodes (m, L, 4), params (m, 8), results (m,).

    - ``max_abs_q1``: largest displacement of the oscillator in units of b, exact at an extremum.
    - ``amplitude``, ``v_phase``: of the first harmonic C sin(Psi + phase) of v; ``C2`` is the squared amplitude.
    - ``damping_loss``: energy lost in the damper between base and oscillator, the integral of eps lambda (q1' - e')^2; ``input_work``: work of
      the moving base through spring and damper. Together with ``impact_loss`` and ``friction_loss`` they balance.
    - ``force_work``, ``grounded_damping_loss``: for the same motion driven by the force e + eps lambda e' with the damper fixed to the
      ground, the work of this force on q1 and the integral of eps lambda q1'^2. They balance with the two losses as well. With the
      truncated excitation the machine is of this kind, and both pairs are equal.

    All energies are per period of the orbit, in units of m b^2 omega_0^2.
    """
    table = event_table(model, word, nodes, params)
    modes = np.array(word.modes, dtype=float)
    turn = 2.0 * np.pi * periods
    count, length = nodes.shape[:2]
    spans = np.diff(np.concatenate([table.phase, table.phase[:, :1] + turn], axis=1), axis=1)
    states = np.zeros((count, length, 8))
    states[:, :, 0] = table.phase
    states[:, :, 1] = table.w
    states[:, :, 2] = np.where(modes == 0.0, 0.0, table.rate_post)
    states[:, :, 3] = modes
    states[:, :, 6] = table.v
    states[:, :, 7] = table.v_rate
    result = {name: np.empty(count) for name in wanted}
    shape = np.empty((length, 4))
    work = np.empty((length, 3))
    functions = stepper(model.name)
    eps = np.asarray(model.column(params, "mass_ratio"))
    power = any(name in POWERS for name in wanted)
    for i in range(count):
        functions.shapes(states[i], params[i], spans[i], shape)
        sine, cosine = 2.0 / turn * shape[:, 1].sum(), 2.0 / turn * shape[:, 2].sum()
        values: dict[str, float] = {
            "max_abs_q1": shape[:, 0].max(),
            "amplitude": math.hypot(sine, cosine),
            "v_phase": math.atan2(cosine, sine),
            "C2": sine**2 + cosine**2,
        }
        if power:
            from orbits.machines.rest import share_of_the_base

            functions.works(states[i], params[i], spans[i], work)
            force, ground = work[:, 0].sum() / eps[i], work[:, 1].sum() / eps[i]
            more = share_of_the_base(model.rest.law(params[i]), periods, shape[:, 3].sum())
            values |= {
                "force_work": force,
                "grounded_damping_loss": ground,
                "input_work": force + more,
                "damping_loss": ground + more,
            }
        for name in wanted:
            result[name][i] = values[name]
    return result


LEFT_IMPACT, RIGHT_IMPACT = CODES["L"], CODES["R"]  # 0 and 1, smaller than all other codes


@dataclass(frozen=True)
class EventTable:
    """Positions and velocities at each event; all arrays have shape (m, L).

    Attributes
    ----------
    phase : float array
        Psi, radians from the start of the forcing.
    w, rate_post, rate_pre : float array
        Relative position; relative velocity after and before the event.
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


def event_table(model: Model, word: Word, nodes: np.ndarray, params: np.ndarray) -> EventTable:
    """Return positions and velocities at all events, from nodes (m, L, n) and parameter vectors (m, P)."""
    phase = nodes[:, :, 0]
    v, v_rate = model.cavity_motion(nodes, params)
    hits, walls, r = contacts(model, word, params)
    w = np.where(hits, walls, nodes[:, :, 1])
    rate_post = np.where(hits, v_rate - nodes[:, :, 1], 0.0)
    rate_pre = np.where(hits, -rate_post / r, 0.0)
    return EventTable(phase, w, rate_post, rate_pre, v_rate - rate_post, v_rate - rate_pre, v, v_rate)


def contacts(model: Model, word: Word, params: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return which events are impacts, shape (L,), and the places and restitutions of their walls, shape (m, L)."""
    codes = word.codes
    left, hits = codes == LEFT_IMPACT, codes <= RIGHT_IMPACT
    (at_left, at_right), (by_left, by_right) = model.walls(params), model.restitutions(params)
    walls = np.where(left, at_left[:, None], at_right[:, None])
    return hits, walls, np.where(left, by_left[:, None], by_right[:, None])


class Placed(Protocol):
    """A motion with its nodes, shape (L, n), and its parameters."""

    @property
    def model(self) -> Varying: ...
    @property
    def word(self) -> Word: ...
    @property
    def nodes(self) -> np.ndarray: ...
    @property
    def params(self) -> np.ndarray: ...


def events_of(motion: Placed) -> EventTable:
    """Return positions and velocities at the events of one motion; arrays of shape (L,).

    Raises
    ------
    AttributeError
        If the motion belongs to a declared machine.
    """
    model = motion.model
    if not isinstance(model, Model):
        raise AttributeError(
            f"events are of built-in machines; {model.name!r} is declared: its orbits have nodes, a row per event with the states after it, and a word"
        )
    table = event_table(model, motion.word, motion.nodes[None], motion.params[None])
    return EventTable(**{name: values[0] for name, values in vars(table).items()})
