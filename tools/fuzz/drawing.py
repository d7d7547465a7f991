"""Random machines with a first orbit; their parameters include strong friction and small restitution."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from orbits import Absorber, Cavity, Coupled, ParameterError
from orbits.attractors import find_attractor
from orbits.starts.find import StartError, polish

MASS_RATIOS = {
    "absorber": (0.0, 0.006, 0.05),
    "cavity": (0.0, 0.006, 0.05),
    "coupled": (0.002, 0.006, 0.05, 0.3),
    "level": (0.0, 0.006, 0.05),  # a level cavity that is symmetric except for the distances of its walls
}
KINDS = tuple(MASS_RATIOS)
TRIES = 4  # random starts from which a periodic motion is sought
# shares of diagrams that begin with a closed form, and with the absorber at rest
CLOSED_FORM, AT_REST = 0.15, 0.1


class Draw(NamedTuple):
    """A machine, parameter values of its first orbit, this orbit (None: no periodic motion was found) and options of the diagram."""

    machine: Any
    parameters: dict[str, float]
    orbit: Any
    options: dict[str, Any]


def draw(kind: str, salt: int, seed: int) -> Draw:
    """Draw the machine of a seed."""
    rng = np.random.default_rng([salt, KINDS.index(kind), seed])
    machine = _machine(kind, rng)
    if kind == "coupled":
        return _coupled(machine, rng)
    friction = machine.friction_acceleration(machine.vector({"amplitude": 1.0}))
    reach = 0.4
    for _ in range(TRIES):
        amplitude = float(rng.uniform(0.1, 2.0) + rng.uniform(0.0, 1.0) * friction)
        parameters = {"amplitude": amplitude}
        orbit = _first(machine, parameters, rng)
        if orbit is not None:
            break
    within = (max(0.05, amplitude - reach), amplitude + reach)
    return Draw(machine, parameters, orbit, {"over": "amplitude", "within": within, **_how(rng)})


def _how(rng: np.random.Generator) -> dict[str, Any]:
    return {"depth": int(rng.integers(1, 4)), "virtual": bool(rng.random() < 0.3)}


def _restitution(rng: np.random.Generator, low: float) -> float:
    return float(rng.uniform(0.02, 0.3) if rng.random() < 0.25 else rng.uniform(low, 0.95))


def _machine(kind: str, rng: np.random.Generator) -> Any:
    eps = float(rng.choice(MASS_RATIOS[kind]))
    draws = rng.random(2)
    friction, gravity = float(rng.uniform(0.0, 1.0)), float(rng.uniform(0.05, 0.5))
    if draws[0] < 0.12:
        friction = 0.0
    elif draws[0] < 0.4:  # mu g above 0.25
        friction, gravity = float(rng.uniform(0.5, 1.0)), float(rng.uniform(0.5, 1.0))
    frequency = 1.0 if draws[1] < 0.5 else float(rng.uniform(0.7, 1.4))
    common = {"gravity": gravity, "mass_ratio": eps}
    if kind == "absorber":
        return Absorber(restitution=_restitution(rng, 0.3), friction=friction, frequency=frequency, **common)
    if kind == "coupled":
        return Coupled(
            restitution=_restitution(rng, 0.3),
            friction=friction,
            damping=rng.uniform(0.3, 2.0),
            forcing=rng.uniform(1.0, 4.0),
            frequency=1.0 + 0.3 * np.sqrt(eps) * rng.uniform(-1.0, 1.0),
            excitation=str(rng.choice(["exact", "truncated"])),
            **common,
        )
    if kind == "level":
        return Cavity(
            restitution=_restitution(rng, 0.3),
            friction=friction,
            distance_left=rng.uniform(0.6, 1.4),
            distance_right=rng.uniform(0.6, 1.4),
            frequency=frequency,
            **common,
        )
    return Cavity(
        restitution_left=_restitution(rng, 0.3),
        restitution_right=_restitution(rng, 0.3),
        friction_left=friction,
        friction_right=friction and float(rng.uniform(0.5, 1.5)) * friction,
        slope=rng.uniform(-0.4, 0.4) if rng.random() < 0.8 else 0.0,
        distance_left=rng.uniform(0.6, 1.4),
        distance_right=rng.uniform(0.6, 1.4),
        frequency=frequency,
        **common,
    )


def _coupled(machine: Any, rng: np.random.Generator) -> Draw:
    over = "frequency" if rng.random() < 0.67 else "forcing"
    width = 0.3 * np.sqrt(machine.mass_ratio)  # approximate width of the resonance
    reach, middle = (width if over == "frequency" else 1.0), float(getattr(machine, over))
    for _ in range(TRIES):
        orbit = _first(machine, {}, rng)
        if orbit is not None:
            break
    within = (max(0.2, middle - reach), middle + reach)
    return Draw(machine, {}, orbit, {"over": over, "within": within, **_how(rng)})


def _first(machine: Any, parameters: dict[str, float], rng: np.random.Generator) -> Any:
    """Return a first orbit: a closed form, the absorber at rest, or the motion on which a simulation from a random start settles."""
    way = rng.random()
    if way < AT_REST or (way < AT_REST + CLOSED_FORM and not isinstance(machine, Absorber)):
        orbit = _at_rest(machine, parameters)
        if orbit is not None:
            return orbit
    elif way < AT_REST + CLOSED_FORM:
        try:
            orbit = machine.symmetric_orbit(**parameters)
        except ParameterError:
            orbit = None
        if orbit is not None and orbit.real:
            return orbit
    start = machine.random_start(machine.vector(parameters), rng)
    if isinstance(machine, Coupled):
        start["v"] = rng.uniform(0.2, 1.5)
    found = find_attractor(machine, start, max_period=4, patience=1, **parameters)
    if found.kind == "stuck":
        return _at_rest(machine, parameters)
    if found.word is None or not len(found.word):
        return None  # chaos, accumulating impacts, or free motion without impacts
    return polish(found.orbit)


def _at_rest(machine: Any, parameters: dict[str, float]) -> Any:
    try:
        orbit = machine.orbit("", **parameters)
    except StartError:
        return None
    return orbit if orbit.real else None
