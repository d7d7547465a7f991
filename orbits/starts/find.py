"""Find a first orbit with a given word: from a guess, a closed form, simulation, or random nodes."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.flows import flow_of
from orbits.flows.equations import solved_nodes
from orbits.flows.protocol import SimulationError
from orbits.orbit import Orbit
from orbits.simulation.replaying import BACKWARD
from orbits.words import Word, WordError

if TYPE_CHECKING:
    from orbits.machines.base import Model
    from orbits.machines.varying import Varying


NEARBY = 0.1  # largest residual of a guess whose nodes may begin at another event than the word
BETTER = 0.1  # factor by which another rotation must reduce the residual to be tried first
LONG = 12  # events of a word that a warning shows
LONGEST = 24  # longest word, in events, for which random nodes are tried
TRIALS = 24  # starts that are simulated


class StartWarning(UserWarning):
    """The orbit was not found from the guess, or is virtual."""


class StartError(ValueError):
    """No orbit was found; the message lists the methods tried and the nearest simulated motion."""


def polish(orbit: Orbit, limit: int = 30) -> Orbit | None:
    """Solve for the orbit by Newton's method from its nodes, at fixed parameters; None if it does not converge."""
    half = orbit.symmetric and orbit.model.has_mirror(orbit.params, orbit.model.default_parameter)
    nodes = solved_nodes(orbit.system(half), orbit.nodes, orbit.params, limit)
    if nodes is None:
        return None
    if orbit.forced:
        nodes[:, 0] -= 2.0 * np.pi * np.floor(nodes[0, 0] / (2.0 * np.pi))
    return replace(orbit, nodes=nodes)


def check_guess(
    word: Word, names: Sequence[str], guess: Sequence[Sequence[float]] | np.ndarray | None
) -> np.ndarray:
    """Convert a guess to an array (L, n).

    Raises
    ------
    StartError
        If its shape does not fit the word, or a number in it is not finite.
    """
    try:
        nodes = np.array(guess, dtype=float)
    except (TypeError, ValueError):
        raise StartError(f"guess = {guess!r} is no table of numbers: give one list per event") from None
    if nodes.shape != (max(len(word), 1), len(names)):
        columns = f"[{', '.join(names)}]"
        raise StartError(
            f"guess has the shape {nodes.shape}, but the word {word.text!r} has {len(word)} events "
            f"({' '.join(word.events)}): give one {columns} for each, slips included"
        )
    if not np.all(np.isfinite(nodes)):
        raise StartError(
            "guess has numbers that are not finite: give a phase and a velocity or position per event"
        )
    return nodes


def find(
    model: Varying,
    word: str | Word,
    periods: int = 1,
    guess: Sequence[Sequence[float]] | np.ndarray | None = None,
    parameters: Mapping[str, float] | None = None,
) -> Orbit:
    """Find the orbit of a machine with a given word.

    Parameters
    ----------
    model : Model or Machine
    word : str or Word
        Events, or of a built-in machine the paper's maps.
    periods : int
        Forcing periods k >= 1; of a self-excited machine 1.
    guess : array (L, n), optional
        Nodes to start Newton's method from. Without it: the closed forms, then simulation from many starts, then
        Newton's method from many random nodes.
    parameters : mapping
        Values of further parameters, in place of the machine's own.

    Raises
    ------
    StartError
        If no orbit with this word is found.
    ParameterError, WordError
        For bad parameters and words.
    """
    params = model.vector(parameters)
    reading = model.word(word, params)
    if isinstance(periods, bool) or int(periods) != periods or periods < 1:
        raise StartError(
            f"periods = {periods!r} closes no orbit: give a whole number of forcing periods, 1 or more"
        )
    periods = int(periods)
    if not reading.modes:  # the absorber rides with its cavity
        return _stuck(Orbit.at_rest(model, params))
    tried = []
    if guess is not None:
        nodes = check_guess(reading, model.node_names, guess)
        centred(model, reading, nodes)
        if reading.alphabet.alone is not None:
            reading = directed(word, reading, nodes)
        orbit = _from_guess(Orbit(model, reading, periods, nodes, params))
        if orbit is not None:
            _warn_virtual(orbit)
            return orbit
        tried.append("Newton's method from the guess")
    else:
        for nodes in model.start_nodes(reading, periods, params):
            orbit = polish(Orbit(model, reading, periods, nodes, params))
            if orbit is not None:
                return orbit
        tried.append("the closed forms")
    orbit, nearest = _simulated(model, reading, periods, params)
    if orbit is not None:
        _warn(guess, reading, "simulation from many starts")
        return orbit
    tried.append("simulation from many starts")
    if guess is None:
        orbit = _random(model, reading, periods, params)
        if orbit is not None:
            return orbit
        tried.append("Newton's method from random nodes")
    orbit = _repeated(model, reading, periods, parameters)
    if orbit is not None:
        _warn(guess, reading, "a shorter orbit, written several times")
        return orbit
    unshaken = model.unshaken(params)
    if unshaken is not None:
        zero, example = unshaken
        raise StartError(
            f"{zero}: nothing shakes the machine, so no motion with the word {reading.text!r} lasts; for example {example}"
        )
    found = (
        f"the nearest motion that the simulator finds is {nearest}"
        if nearest
        else "the simulator finds no periodic motion"
    )
    given = ", ".join(
        f"{name} = {value if isinstance(value, str) else format(value, 'g')}"  # a quantity is text
        for name, value in (parameters or {}).items()
    )
    raise StartError(
        f"no orbit {reading.text!r} with periods = {periods} was found{' at ' + given if given else ''}; tried: "
        f"{', '.join(tried)}; {found}. Change the word, the periods or the parameters, or give a guess of the nodes."
    )


def centred(model: Varying, word: Word, nodes: np.ndarray) -> None:
    """Centre the coordinates that are free in every motion with this word."""
    for j in flow_of(model).loose(model, word):
        nodes[:, j] -= 0.5 * (nodes[:, j].max() + nodes[:, j].min())


def _from_guess(first: Orbit) -> Orbit | None:
    """Solve from a guess whose nodes may begin at another event of the word, or belong to the mirror image; real orbits first."""
    mirrored = first.model.has_mirror(first.params, first.model.default_parameter)

    others = [replace(first, word=reading) for reading in readings(first.word, mirrored)]
    better = [orbit for orbit in others if orbit.residual < min(NEARBY, BETTER * first.residual)]
    virtual = None
    for guess in (*sorted(better, key=lambda orbit: orbit.residual), first):
        orbit = polish(guess, limit=100)
        if orbit is not None and _proper(orbit):
            if orbit.real:
                return orbit
            virtual = virtual or orbit
    return virtual


def _warn(guess: Sequence[Sequence[float]] | np.ndarray | None, word: Word, instead: str) -> None:
    if guess is not None:
        text = word.text if len(word) <= LONG else f"{word.text[:LONG]}..."
        warnings.warn(
            f"the guess does not lead to an orbit {text!r}; the orbit was found by {instead}",
            StartWarning,
            stacklevel=4,
        )


def _warn_virtual(orbit: Orbit) -> None:
    if orbit.real:
        return
    least = min(orbit.margins, key=lambda margin: margin.value)
    events = orbit.word.events
    place = f" at event {least.segment + 1} ({events[least.segment]})" if events else ""
    warnings.warn(
        f"the guess leads to an orbit that no machine follows: the margin {least.kind!r}{place} is {least.value:.3g}, below 0; check that phases and positions of the guess belong "
        "to one motion, and to this word",
        StartWarning,
        stacklevel=4,
    )


def _repeated(
    model: Varying, word: Word, periods: int, parameters: Mapping[str, float] | None
) -> Orbit | None:
    """A shorter orbit repeated several times, if the word is a repetition without an orbit of its own."""
    times = math.gcd(word.repetitions, periods)
    if times == 1:
        return None
    try:
        return find(model, word.head(len(word) // times), periods // times, None, parameters).repeat(times)
    except StartError:
        return None


def _stuck(orbit: Orbit) -> Orbit:
    if not orbit.real:
        advice = "use a smaller amplitude or forcing, or the word 'ss' for stick-slip"
        if not orbit.model.has_mirror(orbit.params):  # on a slope it may slide down and lie on a wall
            advice += "; if gravity pulls it to a wall and keeps it there, there is no motion to follow: give more friction or a smaller slope"
        raise StartError(
            f"word = '' is the stuck absorber, but friction does not hold it here (it is short of {-orbit.margin:.3g}); {advice}"
        )
    return orbit


def _proper(orbit: Orbit) -> bool:
    """Whether time runs forward through the nodes."""
    return bool(np.all(orbit.durations >= BACKWARD))


def _simulated(model: Varying, word: Word, periods: int, params: np.ndarray) -> tuple[Orbit | None, str]:
    """An attractor with this word (else None), and a description of the simulated motion with the nearest word."""
    mirrored = model.has_mirror(params)
    from orbits.attractors.search import find_attractor

    target = word.canonical(mirrored)
    values: dict[str, Any] = model.named(params)
    nearest, distance = "", np.inf
    generator = np.random.default_rng(20)
    for trial in range(TRIALS):
        start = None if trial == 0 else model.random_start(params, generator)
        try:
            attractor = find_attractor(
                model, start, max_period=max(8, 2 * periods), patience=model.patience, **values
            )
        except SimulationError:
            continue  # the start lies inside a wall
        if attractor.kind not in ("periodic", "sliding") or attractor.word is None:
            continue
        orbit = attractor.found
        centred(model, orbit.word, orbit.nodes)
        if orbit.word.canonical(mirrored) == target and orbit.periods == periods:
            polished = polish(_aligned(orbit, word))
            if polished is not None:
                return polished, ""
        gap = (
            abs(orbit.word.impacts - word.impacts)
            + abs(len(orbit.word) - len(word))
            + abs(orbit.periods - periods)
        )
        if gap < distance:
            nearest, distance = f"{orbit.word.text!r} with periods = {orbit.periods}", gap
    return None, nearest


def _aligned(orbit: Orbit, word: Word) -> Orbit:
    """Rotation or mirror image of the orbit whose word is exactly `word`."""
    images = (orbit, orbit.mirror()) if orbit.model.has_mirror(orbit.params) else (orbit,)
    for candidate in images:
        for place in range(len(word)):
            if candidate.word.rotate(place) == word:
                return candidate.rotate(place)
    return orbit


def _random(model: Varying, word: Word, periods: int, params: np.ndarray) -> Orbit | None:
    """Solve from random nodes, if the machine can draw them: the first real orbit, else the first one in which time runs forward."""
    if len(word) > LONGEST:
        return None
    generator = np.random.default_rng(7)
    fallback = None
    for _ in range(300):
        nodes = model.random_nodes(word, periods, params, generator)
        if nodes is None:
            return None
        orbit = polish(Orbit(model, word, periods, nodes, params), limit=25)
        if orbit is None or not _proper(orbit):
            continue
        root = orbit.root()
        if (len(root.word), root.periods) != (len(word), periods):
            continue
        if orbit.real:
            return orbit
        fallback = fallback or orbit
    return fallback


def directed(text: str | Word, reading: Word, nodes: np.ndarray) -> Word:
    """Set the directions of the flights that a word leaves open to those of the guess.

    Parameters
    ----------
    text : str or Word
        The word as given by the user.
    reading : Word
        The parsed word, open directions set by default.
    nodes : float array (L, n)
        The guess: (Psi, B+) at impacts and (Psi, w) elsewhere.

    Raises
    ------
    StartError
        If directions are stated, with ``s+`` or ``s-``, and the guess goes the other way.
    """
    if reading.frictionless:
        return reading
    places = np.array(
        [{"L": 1.0, "R": -1.0}.get(letter, w) for letter, w in zip(reading.events, nodes[:, 1])]
    )
    directions = np.sign(np.roll(places, -1) - places)
    found = max(
        (reading, *_other_directions(reading, directions)), key=lambda word: _agreement(word, directions)
    )
    if found.modes == reading.modes or _agreement(found, directions) < np.count_nonzero(found.modes):
        return reading
    stated = not isinstance(text, str) or "+" in text or "-" in text or "−" in text
    if stated:
        raise StartError(
            f"guess moves the other way than the word {reading.text!r} says: its positions w belong to {found.text!r}; "
            "give that word, or the mirror image of the guess (w with the opposite sign, half a forcing period later)"
        )
    return found


def _agreement(word: Word, directions: np.ndarray) -> float:
    return float(np.dot(word.modes, directions))


def _other_directions(reading: Word, directions: np.ndarray) -> list[Word]:
    """Words with the same letters and other directions of flight."""
    found = [reading.mirror()] if reading.impact_free else []
    slips = [
        f"{letter}{'+' if direction > 0.0 else '-'}" if letter == "u" and direction else letter
        for letter, direction in zip(reading.events, directions)
    ]
    with suppress(WordError):
        found.append(Word.parse("".join(slips)))
    return found


def readings(word: Word, mirror: bool) -> list[Word]:
    """Other rotations of a word, and those of its mirror image, each once."""
    images = (word, word.mirror()) if mirror else (word,)
    found: list[Word] = []
    for image in images:
        for place in range(len(word)):
            turned = image.rotate(place)
            if turned != word and turned not in found:
                found.append(turned)
    return found


def closed_orbits(model: Model, params: np.ndarray, orbit_class: type[Orbit]) -> Iterator[Orbit]:
    """Yield the real orbits among rest and the closed forms (`Model.closed_words`), stable or not.

    Parameters
    ----------
    model : Model
    params : float array (P,)
    orbit_class : type
        Class of the orbits: `orbits.orbit.Orbit` or a subclass.
    """
    rest = orbit_class.at_rest(model, params)
    if rest.real:
        yield rest
    for text in model.closed_words:
        word = Word.parse(text, frictionless=model.frictionless(params))
        for nodes in model.start_nodes(word, 1, params):
            orbit = polish(orbit_class(model, word, 1, nodes, params))
            if orbit is not None and orbit.real:
                yield orbit
