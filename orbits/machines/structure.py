"""A linear structure with harmonic forces and local contacts, as a declared machine.

    M x'' + C x' + K x = sum of forces A cos(n phase + shift) + contact forces.

Contacts are:

- walls: rigid, with Newton's restitution; or elastic, a spring and perhaps a damper beyond a gap that push and never pull;
- dry friction;
- absorbers: a mass with dry friction in a cavity fixed to a degree of freedom.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.near_names import did_you_mean
from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.switch import Switch
from orbits.contacts.wall import Wall
from orbits.machines.page.machine import Machine
from orbits.machines.parameters import ParameterError
from orbits.machines.reduction import Given, Reduced, matrix, reduced
from orbits.symbols import cos, sqrt

if TYPE_CHECKING:
    from orbits.machines.page.page import Named, States
    from orbits.machines.page.patterns import Contact
    from orbits.symbols import Plain

Element = Mapping[str, float]
FIELDS: dict[
    str, dict[str, float | None]
] = {  # fields of each kind of element with defaults; None: must be given
    "force": {"at": None, "amplitude": None, "shift": 0.0, "harmonic": 1.0},
    "wall": {
        "at": None,
        "to": 0.0,
        "side": 1.0,
        "gap": None,
        "restitution": math.nan,
        "stiffness": math.nan,
        "loss": 0.0,
    },
    "friction": {"at": None, "to": 0.0, "limit": None},
    "absorber": {"at": None, "mass": None, "clearance": None, "restitution": None, "friction": 0.0},
}
"""Fields of each kind of element; ``at`` and ``to`` are degrees of freedom, counted from 1 (``to`` 0 is the ground), ``friction`` of an absorber
is the largest friction force."""
MATRICES = ("mass", "damping", "stiffness")
GIVEN = ("forces", "walls", "frictions", "absorbers", "highest", "accuracy")
"""Further arguments of a structure."""
FIXED = ("at", "to", "side", "harmonic", "shift")  # fields that are no parameters of the machine
MEANT = 5.0  # highest frequency at which the reduction must be accurate, over the frequency of the forces


class Structure(Machine):
    """A structure, made by `structure`."""

    reduction: Reduced
    elements: dict[str, list[dict[str, float]]]

    def settings(self, params: np.ndarray | None = None) -> dict[str, Any]:
        """Return everything that `structure_again` needs, ready for JSON: reduced matrices, elements and parameters."""
        small = self.reduction
        matrices = {name: getattr(small, name).tolist() for name in MATRICES}
        data = vars(small) | matrices | {"kept": list(small.kept), "elements": self.elements}
        values = self.parameters if params is None else self.named(params)
        return {"name": self.name, "structure": data, **values}

    def __reduce__(self) -> tuple[Any, ...]:
        return structure_again, (self.settings(),)


def structure(
    mass: Given,
    damping: Given,
    stiffness: Given,
    *,
    forces: Sequence[Element] = (),
    walls: Sequence[Element] = (),
    frictions: Sequence[Element] = (),
    absorbers: Sequence[Element] = (),
    frequency: float = 1.0,
    highest: float | None = None,
    accuracy: float = 0.01,
    folder: Path | None = None,
) -> Structure:
    """Return a structure from its matrices.

    Parameters
    ----------
    mass, damping, stiffness : nested list, array, or str
        (n, n); or a file, see `orbits.machines.reduction.matrix`.
    forces, walls, frictions, absorbers : sequences of mapping
        Their fields are in `FIELDS`: ``{"at": 2, "amplitude": 0.1}``, ``{"at": 1, "gap": 1.0, "stiffness": 100.0}`` (with ``loss`` a
        damper parallel to the spring) or ``{"at": 1, "to": 2, "gap": 1.0, "restitution": 0.8}``, ``{"at": 1, "limit": 0.2}``,
        ``{"at": 2, "mass": 0.05, "clearance": 0.5, "restitution": 0.6, "friction": 0.01}``. A wall is reached at x_at - x_to = gap, with
        ``side = -1`` at minus the gap.
    frequency : float
        Frequency of the forces, radians per unit of time.
    highest, accuracy : float
        With more than 8 degrees of freedom the structure is reduced: receptances up to `highest` (five times the frequency by default) are
        kept to this relative accuracy.
    folder : Path, optional
        Folder of the files.

    Returns
    -------
    Structure
        States ``x1, v1, ...`` of the degrees of freedom that remain, ``m1, n1, ...`` of modes, ``y1, w1, ...`` of absorbers; parameters
        ``frequency``, ``force_amplitude``, ``wall_gap``, ... (``wall1_gap``, ``wall2_gap`` if there are several).

    Raises
    ------
    ParameterError
        The message names the field, the value and the remedy.
    """
    matrices = [
        matrix(name, given, folder)
        for name, given in (("mass", mass), ("damping", damping), ("stiffness", stiffness))
    ]
    size = len(matrices[0])
    for name, given in zip(("damping", "stiffness"), matrices[1:]):
        if len(given) != size:
            raise ParameterError(f"{name} has {len(given)} degrees of freedom, mass has {size}")
    given = {"force": forces, "wall": walls, "friction": frictions, "absorber": absorbers}
    elements = {
        kind: [_element(kind, k, element, size) for k, element in enumerate(each)]
        for kind, each in given.items()
    }
    coordinates = sorted(
        {int(e[end]) - 1 for each in elements.values() for e in each for end in ("at", "to") if e.get(end)}
    )
    if not coordinates:
        raise ParameterError(
            "a structure without forces and contacts does not move: give forces = [{ at = 1, amplitude = 0.1 }]"
        )
    if not (0.0 < accuracy < 1.0 and frequency > 0.0):
        raise ParameterError(
            f"frequency = {frequency:g}, accuracy = {accuracy:g}: expected a frequency above 0 and an accuracy from 0 to 1"
        )
    return _machine_from(
        reduced(matrices[0], matrices[1], matrices[2], coordinates, highest or MEANT * frequency, accuracy),
        elements,
        frequency,
    )


def structure_again(settings: Mapping[str, Any]) -> Structure:
    """Return the structure with these settings."""
    data = settings["structure"]
    m, c, k = (np.array(data[name]) for name in MATRICES)
    small = Reduced(m, c, k, tuple(data["kept"]), data["size"], data["error"], data["highest"])
    values = {key: value for key, value in settings.items() if key not in ("name", "structure")}
    return _machine_from(small, data["elements"], values.get("frequency", 1.0), values)


def _element(kind: str, place: int, given: object, size: int) -> dict[str, float]:
    """Return an element with all its fields, checked."""
    label, fields = f"{kind}s[{place}]", FIELDS[kind]
    if not isinstance(given, Mapping):
        raise ParameterError(f"{label} = {given!r}: expected fields such as {dict.fromkeys(fields, 1.0)}")
    for name, value in given.items():
        if name not in fields:
            raise ParameterError(
                f"{label}: there is no field {name!r}{did_you_mean(name, fields)}; a {kind} has {', '.join(fields)}"
            )
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise ParameterError(f"{label}: {name} = {value!r} is no finite number")
    for name, default in fields.items():
        if default is None and name not in given:
            raise ParameterError(f"{label}: {name} is missing")
    found = {name: float(given.get(name, default)) for name, default in fields.items()}  # type: ignore[arg-type]
    for end in ("at", "to"):
        low = 1 if end == "at" else 0
        if end in found and not (found[end] == int(found[end]) and low <= found[end] <= size):
            raise ParameterError(
                f"{label}: {end} = {found[end]:g} is no degree of freedom; expected {low} to {size}"
            )
    if found.get("to") == found["at"]:
        raise ParameterError(f"{label}: at and to are both {found['at']:g}; to = 0 is the ground")
    if kind == "wall" and math.isnan(found["restitution"]) == math.isnan(found["stiffness"]):
        raise ParameterError(f"{label}: give restitution, of a rigid wall, or stiffness, of an elastic one")
    if kind == "wall" and abs(found["side"]) != 1.0:
        raise ParameterError(f"{label}: side = {found['side']:g}; expected 1 or -1")
    for name in ("mass", "stiffness", "clearance", "harmonic"):
        if not (found.get(name, 1.0) > 0.0 or math.isnan(found[name])):
            raise ParameterError(f"{label}: {name} = {found[name]:g} is out of range; give a number above 0")
    return {name: value for name, value in found.items() if not math.isnan(value)}


class _Space:
    """Coordinates of a reduced structure and of its absorbers, positions before speeds, and the effect of forces along a direction.

    A direction, shape (coordinates,), has 1 at the coordinate on which a force acts and -1 at that of the reaction.
    """

    def __init__(self, small: Reduced, elements: Mapping[str, Sequence[Element]]) -> None:
        self.small, self.elements, self.count = small, elements, len(small.mass)
        self.place = {degree + 1: i for i, degree in enumerate(small.kept)}
        self.inverse = np.linalg.inv(small.mass)
        modes = range(1, self.count - len(small.kept) + 1)
        names = [(f"x{d + 1}", f"v{d + 1}") for d in small.kept] + [(f"m{i}", f"n{i}") for i in modes]
        names += [(f"y{i}", f"w{i}") for i in range(1, len(elements["absorber"]) + 1)]
        self.speeds = [v for _, v in names]
        self.states = (*(x for x, _ in names), *self.speeds)

    def name(self, kind: str, k: int, field: str) -> str:
        """Return the name of the parameter that a field of an element becomes."""
        return f"{kind}{k + 1 if len(self.elements[kind]) > 1 else ''}_{field}"

    def direction(self, element: Element, absorber: int | None = None) -> np.ndarray:
        """Return the direction x_at - x_to; of an absorber x_at - y."""
        found = np.zeros(len(self.speeds))
        found[self.place[int(element["at"])]] = element.get("side", 1.0)
        if element.get("to"):
            found[self.place[int(element["to"])]] = -element.get("side", 1.0)
        if absorber is not None:
            found[self.count + absorber] = -1.0
        return found

    def stretch(self, state: States, direction: np.ndarray) -> Plain:
        """Return the distance between the ends of a direction."""
        return _sum(direction, state[: len(self.speeds)])

    def stretching(self, state: States, direction: np.ndarray) -> Plain:
        """Return the rate of this distance."""
        return _sum(direction, state[len(self.speeds) :])

    def faster(self, i: int, direction: np.ndarray, force: Plain, p: Named) -> Plain:
        """Return the contribution of a force along a direction to the rate of speed i."""
        if i >= self.count:
            part, mass = float(direction[i]), getattr(p, self.name("absorber", i - self.count, "mass"))
            return part * force / mass if part else 0.0
        part = float(self.inverse[i] @ direction[: self.count])
        return part * force if part else 0.0

    def wall(self, letter: str, direction: np.ndarray, gap: str, restitution: str) -> Wall:
        """Return a rigid wall that is reached when the distance along a direction equals the gap; it pushes against the direction."""

        def push(i: int) -> Callable[..., Plain]:
            return lambda state, phase, p: self.faster(i, -direction, 1.0, p)

        return Wall(
            letter,
            lambda state, phase, p: getattr(p, gap) - self.stretch(state, direction),
            {speed: push(i) for i, speed in enumerate(self.speeds)},
            restitution,
        )

    def friction(self, name: str, direction: np.ndarray, limit: str, number: int) -> DryFriction:
        """Return dry friction between the ends of a direction."""
        letters = tuple(f"{letter}{number}" for letter in "tsu")
        return DryFriction(
            name, lambda state, phase, p: self.stretching(state, direction), limit, letters=letters
        )

    # ------------------------------------------------------------------ elastic walls
    def beyond(self, k: int, wall: Element, state: States, p: Named) -> Plain:
        """Return the penetration of an elastic wall (negative before contact)."""
        return self.stretch(state, self.direction(wall)) - getattr(p, self.name("wall", k, "gap"))

    def press(self, k: int, wall: Element, state: States, p: Named) -> Plain:
        """Return the force of an elastic wall."""
        force = getattr(p, self.name("wall", k, "stiffness")) * self.beyond(k, wall, state, p)
        if wall["loss"]:
            speed = self.stretching(state, self.direction(wall))
            force = force + getattr(p, self.name("wall", k, "loss")) * speed
        return force

    # ------------------------------------------------------------------ the machine's formulas
    def contacts(self) -> list[Contact]:
        """Return walls, frictions, and two walls and a floor of each absorber."""
        found: list[Contact] = []
        for k, wall in enumerate(self.elements["wall"]):
            if "restitution" in wall:
                gap, restitution = self.name("wall", k, "gap"), self.name("wall", k, "restitution")
                found.append(self.wall(f"W{k + 1}", self.direction(wall), gap, restitution))
                continue
            found.append(
                Switch(f"stop{k + 1}", lambda s, phase, p, k=k, wall=wall: self.beyond(k, wall, s, p))
            )
            if wall["loss"]:
                found.append(
                    Switch(f"holds{k + 1}", lambda s, phase, p, k=k, wall=wall: self.press(k, wall, s, p))
                )
        for k, friction in enumerate(self.elements["friction"]):
            limit = self.name("friction", k, "limit")
            found.append(self.friction(f"rub{k + 1}", self.direction(friction), limit, k + 1))
        for k, absorber in enumerate(self.elements["absorber"]):
            clearance, restitution, limit = (
                self.name("absorber", k, field) for field in ("clearance", "restitution", "friction")
            )
            along, number = self.direction(absorber, k), len(self.elements["friction"]) + k + 1
            found += [
                self.wall(f"L{k + 1}", along, clearance, restitution),
                self.wall(f"R{k + 1}", -along, clearance, restitution),
            ]
            found.append(self.friction(f"floor{k + 1}", along, limit, number))
        return found

    def motion(self, state: States, phase: Plain, p: Named, contact: Named) -> tuple[Plain, ...]:
        """Return the rates of the states."""
        speeds = state[len(self.speeds) :]
        pushes: list[tuple[np.ndarray, Plain]] = []
        for k, force in enumerate(self.elements["force"]):
            swing = cos(force["harmonic"] * phase + force["shift"])
            pushes.append((self.direction(force), getattr(p, self.name("force", k, "amplitude")) * swing))
        for k, wall in enumerate(self.elements["wall"]):
            if "stiffness" in wall:
                pressed = 0.5 * (1 + getattr(contact, f"stop{k + 1}"))  # 1 if it presses, else 0
                if wall["loss"]:
                    pressed = pressed * (0.5 * (1 + getattr(contact, f"holds{k + 1}")))
                pushes.append((-self.direction(wall), self.press(k, wall, state, p) * pressed))
        for k, friction in enumerate(self.elements["friction"]):
            pushes.append((self.direction(friction), getattr(contact, f"rub{k + 1}")))
        for k, absorber in enumerate(self.elements["absorber"]):
            pushes.append((self.direction(absorber, k), getattr(contact, f"floor{k + 1}")))
        rates: list[Plain] = [0.0] * len(speeds)
        for i in range(self.count):
            spring, damper = -self.inverse[i] @ self.small.stiffness, -self.inverse[i] @ self.small.damping
            rates[i] = _sum(spring, state[: self.count]) + _sum(damper, speeds[: self.count])
        for i in range(len(speeds)):
            for direction, force in pushes:
                rates[i] = rates[i] + self.faster(i, direction, force, p)
        return (*speeds, *rates)

    def energy(self, state: States, phase: Plain, p: Named) -> Plain:
        """Return the energy of the structure, its absorbers and its elastic walls (half the stiffness times the squared penetration)."""
        speeds, total = state[len(self.speeds) :], 0.0
        for part, values in ((self.small.stiffness, state), (self.small.mass, speeds)):
            for i in range(self.count):
                total = total + 0.5 * values[i] * _sum(part[i], values[: self.count])
        for k in range(len(self.elements["absorber"])):
            total = total + 0.5 * getattr(p, self.name("absorber", k, "mass")) * speeds[self.count + k] ** 2
        for k, wall in enumerate(self.elements["wall"]):
            if "stiffness" in wall:
                beyond = self.beyond(k, wall, state, p)
                deep = 0.5 * (beyond + sqrt(beyond**2))
                total = total + 0.5 * getattr(p, self.name("wall", k, "stiffness")) * deep**2
        return total


def _sum(factors: np.ndarray, values: Sequence[Plain]) -> Plain:
    total: Plain = 0.0
    for factor, value in zip(factors.tolist(), values):
        if factor:
            total = total + factor * value
    return total


def _machine_from(
    small: Reduced,
    elements: dict[str, list[dict[str, float]]],
    frequency: float,
    values: Mapping[str, float] | None = None,
) -> Structure:
    space = _Space(small, elements)
    parameters = {"frequency": frequency} if elements["force"] else {}
    for kind, each in elements.items():
        for k, element in enumerate(each):
            parameters |= {
                space.name(kind, k, field): value
                for field, value in element.items()
                if field not in FIXED and (field != "loss" or value)
            }
    machine = Structure(
        name="structure",
        states=space.states,
        parameters={**parameters, **(values or {})},
        phase_rate="frequency" if elements["force"] else None,
        motion=space.motion,
        contacts=space.contacts(),
        energy=space.energy,
    )
    machine.reduction, machine.elements = small, elements
    return machine
