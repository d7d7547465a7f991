"""Finding an orbit of a declared machine with a given word."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from orbits.attractors.search import find_attractor
from orbits.contacts.letters import HIT
from orbits.flows.page.solving import SOLVED, newton
from orbits.flows.page.stepper import TWO_PI, SimulationError
from orbits.machines.page.machine import Machine
from orbits.orbit import Orbit
from orbits.starts.find import StartError
from orbits.words.of_pages import PageWord

TRIALS = 12  # simulated starts
SHOTS = 300  # Newton's method from random nodes
LONG = 24  # events; longer words are not guessed at random


def find(
    machine: Machine,
    word: str | PageWord,
    periods: int = 1,
    guess: Any = None,
    parameters: Mapping[str, float] | None = None,
) -> Orbit:
    """Solve for the orbit with a word: from the guess, else among simulated attractors, else by Newton's method from random nodes.

    Parameters
    ----------
    machine : Machine
    word : str or PageWord
    periods : int
        Forcing periods; leave it at 1 for a self-excited machine.
    guess : array_like (L, n + 1), optional
        Per event the phase (of a self-excited machine: the duration of the flight that follows) and the states after it.
    parameters : mapping, optional

    Returns
    -------
    Orbit
        A real one where there is one.

    Raises
    ------
    StartError
        If none is found; the sentence says what was.
    """
    params = machine.vector(parameters)
    if not (isinstance(periods, (int, np.integer)) and periods >= 1):
        raise StartError(f"periods = {periods!r} must be a whole number of at least 1")
    target = machine.word(word, params)
    if guess is not None:
        found = _from_guess(machine, target, periods, guess, params)
        if found is not None:
            return found
    orbit, nearest = _simulated(machine, target, periods, params)
    orbit = orbit or _shot(machine, target, periods, params)
    if orbit is None:
        hint = f"; simulation finds {nearest}" if nearest else ""
        raise StartError(
            f"no orbit with the word {target.text!r} and periods = {periods} was found for {machine.name!r}{hint}; "
            "give a guess (per event the phase and the states after it), other parameters, or leave the word to machine.attractor"
        )
    return orbit


def _from_guess(
    machine: Machine, word: PageWord, periods: int, guess: Any, params: np.ndarray
) -> Orbit | None:
    nodes = np.asarray(guess, dtype=float)
    shape = (max(1, len(word)), machine.size + 1)
    if nodes.shape != shape:
        first = "phase" if machine.forced else "duration"
        raise StartError(
            f"guess has the shape {nodes.shape}; the word {word.text!r} needs {shape[0]} rows of {shape[1]} numbers: "
            f"{first}, {', '.join(machine.states)}"
        )
    orbit = Orbit(machine, word, periods, nodes, params)
    problem = orbit.system(symmetric=False)
    u, _, residual, _ = newton(problem, problem.reduce(nodes), problem.value(params))
    if not residual < SOLVED:
        return None
    return Orbit(machine, word, periods, problem.expand(u), params)


def _aligned(orbit: Orbit, word: PageWord) -> Orbit | None:
    """The orbit in the rotation or mirror image that reads exactly `word`."""
    images = [orbit] + ([orbit.mirror()] if orbit.model.has_mirror(orbit.params) else [])
    for image in images:
        for place in range(max(1, len(word))):
            if image.word.rotate(place) == word:
                return image.rotate(place)
    return None


def _simulated(
    machine: Machine, word: PageWord, periods: int, params: np.ndarray
) -> tuple[Orbit | None, str]:
    """An attractor with this word, or the description of the one whose word is nearest."""
    generator = np.random.default_rng(20)
    values = dict(zip(machine.parameter_names, map(float, params)))
    nearest, distance = "", np.inf
    for trial in range(TRIALS):
        start = None if trial == 0 else machine.random_start(params, generator)
        try:
            found = find_attractor(machine, start, max_period=max(4, 2 * periods), patience=2, **values).orbit
        except SimulationError:
            continue
        if found is None:
            continue
        aligned = _aligned(found, word)
        if aligned is not None and (found.periods == periods or not machine.forced):
            return aligned, ""
        gap = abs(len(found.word) - len(word)) + abs(found.periods - periods)
        if gap < distance:
            nearest, distance = f"{found.word.text!r} with periods = {found.periods}", gap
    return None, nearest


def _shot(machine: Machine, word: PageWord, periods: int, params: np.ndarray) -> Orbit | None:
    """Newton's method from simulated stretches and random nodes: the first real orbit, else the first proper one."""
    if len(word) > LONG:
        return None
    generator = np.random.default_rng(7)
    n = max(1, len(word))
    fallback = None
    for _ in range(SHOTS):
        nodes = generator.uniform(-1.0, 1.0, (n, machine.size + 1))
        if machine.forced:
            nodes[:, 0] = np.sort(generator.uniform(0.0, TWO_PI * periods, n))
        else:
            nodes[:, 0] = generator.uniform(0.1, 6.0, n)
        nodes[:, 1:] *= 10.0 ** generator.uniform(-1.0, 1.0)
        if not len(word):
            nodes[0, 0] = 0.0
        _onto_surfaces(machine, word, params, nodes)
        orbit = polished_anywhere(Orbit(machine, word, periods, nodes, params))
        if orbit is None or len(orbit.root().word) != len(word):
            continue
        if orbit.real:
            return orbit
        durations = [m.value for m in orbit.margins if m.kind == "duration"]
        if min(durations, default=0.0) > 0.0:
            fallback = fallback or orbit
    return fallback


def polished_anywhere(orbit: Orbit) -> Orbit | None:
    """The orbit that Newton's method finds from a guess, real or not."""
    problem = orbit.system(symmetric=False)
    u, _, residual, _ = newton(problem, problem.reduce(orbit.nodes), problem.value(orbit.params), limit=25)
    if not residual < SOLVED:
        return None
    return Orbit(orbit.model, orbit.word, orbit.periods, problem.expand(u), orbit.params)


def _onto_surfaces(machine: Machine, word: PageWord, params: np.ndarray, nodes: np.ndarray) -> None:
    """Random nodes moved so that impacts leave their wall."""
    for i in range(len(word)):
        letter = word.letter(i)
        if letter.kind != HIT:
            continue
        numbers = machine.compiled.numbers(params, word.modes[i])
        clock = nodes[i, :1] if machine.forced else np.zeros(1)
        row = machine.compiled.approach(letter.contact)(nodes[i : i + 1, 1:], clock, numbers[None])[0]
        rate, slope, push = row[0], row[1 : machine.size + 1], row[machine.size + 1 :]
        if rate < 0.0:
            nodes[i, 1:] -= 2.0 * rate / float(slope @ push) * push
