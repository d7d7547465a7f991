"""Measures of the orbits of a declared machine, for arrays of solutions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from orbits.contacts.letters import HIT
from orbits.flows.page.loads import Impacts, friction_work
from orbits.machines.measures import loads, way_out
from orbits.machines.page.si import CONTACT, OF_A_STATE
from orbits.settings import EVENTS, SOLVING
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.machines.page.machine import Machine


def names(model: Machine) -> tuple[str, ...]:
    """max_x, min_x and max_abs_x (the larger of their sizes) over the period, first_x (after the first event), strobe_x (at phase zero) of every state; `phase` of the first
    event, `period`, `rate` (2 pi / period), `approach_speed` (of the fastest impact); forces and energies at the contacts
    (`orbits.machines.page.patterns`), the energies per period of the orbit."""
    what = OF_A_STATE if model.forced else OF_A_STATE[:-1]
    own = [f"{kind}_{state}" for state in model.states for kind in what]
    return (
        *own,
        *(["phase"] if model.forced else []),
        "period",
        "rate",
        *(["approach_speed"] if model.alphabet.walled else []),
        *model.load_names,
    )


def shown_first(model: Machine) -> str:
    """The measure that a diagram shows when none is asked for: what the page says, impact speeds, or how far the first state goes."""
    if model.response is not None:
        return model.response
    return "approach_speed" if "approach_speed" in names(model) else f"max_{model.states[0]}"


def measure(
    model: Machine, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray, wanted: Sequence[str]
) -> dict[str, np.ndarray]:
    """Values, each of shape (m,), of solutions with nodes (m, L, n + 1) and parameters (m, P).

    Raises
    ------
    KeyError
        If there is no such measure.
    """
    known = names(model)
    for name in wanted:
        if name not in known:
            raise KeyError(f"there is no measure {name!r}{way_out(name)}; choose from {', '.join(known)}")
    result: dict[str, np.ndarray] = {}
    period = _periods(model, periods, nodes, params)
    states = {f"{kind}_{state}": (kind, i) for i, state in enumerate(model.states) for kind in OF_A_STATE}
    extremes = None
    if not _LOADS.isdisjoint(name.partition("_")[0] for name in wanted):
        result |= _loads(model, word, periods, nodes, params, period, wanted)
    for name in wanted:
        kind, place = states.get(name, ("", 0))
        if name in result:
            continue
        if name == "phase":
            result[name] = np.mod(nodes[:, 0, 0], 2.0 * np.pi)
        elif name == "period":
            result[name] = period
        elif name == "rate":
            result[name] = 2.0 * np.pi / period
        elif name == "approach_speed":
            result[name] = _approach_speeds(model, word, nodes, params)
        elif kind == "first":
            result[name] = nodes[:, 0, 1 + place].copy()
        elif kind == "strobe":
            result[name] = _strobed(model, word, periods, nodes, params)[:, place]
        else:
            if extremes is None:
                extremes = _extremes(model, word, periods, nodes, params)
            high, low = (side[:, place] for side in extremes)
            result[name] = {"max": high, "min": low, "max_abs": np.maximum(high, -low)}[kind]
    return {name: result[name] for name in wanted}


_LOADS = frozenset(("impact", "impulse", "friction", "mean", "work", "peak"))  # how their names begin


def _loads(
    machine: Machine,
    word: Word,
    periods: int,
    nodes: np.ndarray,
    params: np.ndarray,
    period: np.ndarray,
    wanted: Sequence[str],
) -> dict[str, np.ndarray]:
    """Measures of `machine.load_names`; the sums of impacts are taken wall by wall."""
    zero, walls = np.zeros(len(nodes)), [machine.contacts[j].letter for j in machine.equations.gap]
    letters = [(i, word.letter(i)) for i in range(nodes.shape[1] if len(word) else 0)]
    hits = [(i, letter) for i, letter in letters if letter.kind == HIT]
    each = [
        Impacts(
            machine,
            letter.contact,
            nodes[:, i, 1:],
            nodes[:, i, 0].copy() if machine.forced else zero,
            params,
        )
        for i, letter in hits
    ]
    held = None
    if "peak_force" in machine.load_names:
        held = params[:, machine.parameter_names.index(CONTACT)] * machine.equations.factors.get(CONTACT, 1.0)
    speeds, restitution, mass = (
        np.array([getattr(one, name) for one in each]).reshape(-1, len(nodes)).T
        for name in ("speeds", "restitution", "mass")
    )
    found = loads(speeds, restitution, mass, [letter.text for _, letter in hits], walls, period, held)
    if {"friction_loss", "work_rate"}.intersection(wanted):
        rubbed = zero.copy()
        for k, rows in enumerate(nodes if machine.equations.limit else ()):
            for i, (begin, end) in enumerate(zip(*_spans(machine, periods, rows))):
                mode = word.entries(i)
                rubbed[k] += friction_work(machine, mode, rows[i, 1:], begin, end, params[k])
        found |= {"friction_loss": rubbed, "work_rate": (found["impact_loss"] + rubbed) / period}
    return found


def _periods(machine: Machine, periods: int, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
    if not machine.forced:
        return nodes[:, :, 0].sum(axis=1)
    return 2.0 * np.pi * periods / np.asarray(machine.phase_speed(params))


def _spans(machine: Machine, periods: int, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Clock at the beginning and the end of every flight of one solution."""
    if not machine.forced:
        return np.zeros(len(nodes)), nodes[:, 0]
    return nodes[:, 0], np.append(nodes[1:, 0], nodes[0, 0] + 2.0 * np.pi * periods)


def _extremes(
    machine: Machine, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Largest and smallest value of every state over the period: at the events, and where a rate is zero between them."""
    compiled, e = machine.compiled, machine.equations
    keys = [e.pattern_key(word.entries(i)) for i in range(nodes.shape[1])]
    watches = [compiled.extremes(key) for key in keys]
    largest, smallest = nodes[:, :, 1:].max(axis=1), nodes[:, :, 1:].min(axis=1)
    for k in range(len(nodes)):
        begin, end = _spans(machine, periods, nodes[k])
        for i, watch in enumerate(watches):
            if not 0.0 < end[i] - begin[i] < SOLVING.longest_flight:
                continue
            numbers = compiled.numbers(params[k], word.entries(i))
            found = [state for _, _, state in watch(nodes[k, i, 1:], begin[i], end[i], numbers)]
            found.append(watch.final)
            table = np.array(found)
            largest[k] = np.maximum(largest[k], table.max(axis=0))
            smallest[k] = np.minimum(smallest[k], table.min(axis=0))
    return largest, smallest


def _strobed(machine: Machine, word: Word, periods: int, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
    """States at the first passage of phase zero (a multiple of 2 pi) after the first event."""
    compiled, e = machine.compiled, machine.equations
    out = np.empty((len(nodes), machine.size))
    for k in range(len(nodes)):
        begin, end = _spans(machine, periods, nodes[k])
        target = 2.0 * np.pi * np.ceil(begin[0] / (2.0 * np.pi) - EVENTS.zero)
        i = int(np.clip(np.searchsorted(begin, target, side="right") - 1, 0, len(begin) - 1))
        mode = word.entries(i)
        state = nodes[k, i, 1:].copy()
        compiled.extremes(e.pattern_key(mode)).move(
            state, begin[i], max(target, begin[i]), compiled.numbers(params[k], mode)
        )
        out[k] = state
    return out


def _approach_speeds(machine: Machine, word: Word, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
    """Fastest approach at an impact: the gap's rate before it, from the one after it and the restitution."""
    compiled = machine.compiled
    best = np.zeros(len(nodes))
    if not len(word):
        return best
    numbers = np.hstack([params, np.zeros((len(params), len(machine.equations.signed)))])
    for i in range(nodes.shape[1]):
        letter = word.letter(i)
        if letter.kind != HIT:
            continue
        clock = np.ascontiguousarray(nodes[:, i, 0]) if machine.forced else np.zeros(len(nodes))
        rows = compiled.rebound(letter.contact)(nodes[:, i, 1:], clock, numbers)
        best = np.maximum(best, rows[:, 0] / rows[:, 1])
    return best
