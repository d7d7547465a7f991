"""Measures of an absorber on its oscillator: oscillator's amplitude, first harmonic of v, work of excitation and damper."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from orbits.machines.base import Model
from orbits.machines.events import event_table
from orbits.machines.native_stepper import stepper
from orbits.machines.rest import share_of_the_base
from orbits.words import Word

POWERS = ("input_work", "damping_loss", "force_work", "grounded_damping_loss")


def own_measures(
    wanted: Sequence[str], model: Model, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray
) -> dict[str, np.ndarray]:
    """The measures `wanted` of many orbits with one word; nodes (m, L, 4), params (m, 8), results (m,).

    ``max_abs_q1`` is the largest displacement of the oscillator in units of b (exact, at an extremum), ``amplitude`` and
    ``v_phase`` those of the first harmonic C sin(Psi + phase) of v, ``C2`` the squared amplitude. Over the orbit's
    period, in units of m b^2 omega_0^2 like ``impact_loss`` and ``friction_loss``: ``damping_loss`` is what the damper between
    base and oscillator takes, the integral of eps lambda (q1' - e')^2, and ``input_work`` what the moving base gives through
    spring and damper; the four balance. For the same motion driven by the force e + eps lambda e', its damper held to the
    ground, ``force_work`` is the work of that force on q1 and ``grounded_damping_loss`` the integral of eps lambda q1'^2;
    they balance with the other two as well. With the truncated excitation the machine is that one, and both pairs are one.
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
