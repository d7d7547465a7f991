"""A linear structure with harmonic forces and local contacts, as a declared machine.

    M x'' + C x' + K x = sum of forces A cos(n phase + shift) + contact forces,

with walls (rigid, Newton's restitution; elastic, a spring and perhaps a damper beyond a gap that press and never pull), dry friction, and absorbers: a mass
with dry friction in a cavity that rides on a degree of freedom.
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
from orbits.machines.structure.matrices import Given, matrix
from orbits.machines.structure.reduction import Reduced, reduced
from orbits.symbols import cos, sqrt

if TYPE_CHECKING:
    from orbits.machines.page.formulas import Named, States
    from orbits.machines.page.patterns import Contact
    from orbits.symbols import Plain

Element = Mapping[str, float]
FIELDS: dict[str, dict[str, float | None]] = {  # of each kind of element; None: must be given
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
"""What else a structure is made of."""
FIXED = ("at", "to", "side", "harmonic", "shift")  # no parameters
MEANT = 5.0  # times the frequency of the forces: up to there the reduction is held to its accuracy


class Structure(Machine):
    """A structure; made by `structure`."""

    reduction: Reduced
    elements: dict[str, list[dict[str, float]]]

    def settings(self, params: np.ndarray | None = None) -> dict[str, Any]:
        """All that makes it again, ready for JSON: its reduced matrices, its elements and its parameters."""
        r = self.reduction
        made = {
            **{name: getattr(r, name).tolist() for name in ("mass", "damping", "stiffness")},
            "kept": list(r.kept),
            "size": r.size,
            "error": r.error,
            "highest": r.highest,
            "elements": self.elements,
        }
        values = self.parameters if params is None else self.named(params)
        return {"name": self.name, "structure": made, **values}

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
    """A structure from its matrices.

    Parameters
    ----------
    mass, damping, stiffness : nested list, array, or str
        (n, n); or a file, see `orbits.machines.structure.matrices.matrix`.
    forces, walls, frictions, absorbers : sequences of mapping
        Their fields are in `FIELDS`: ``{"at": 2, "amplitude": 0.1}``, ``{"at": 1, "gap": 1.0, "stiffness": 100.0}`` (with ``loss`` a
        damper beside the spring) or ``{"at": 1, "to": 2, "gap": 1.0, "restitution": 0.8}``, ``{"at": 1, "limit": 0.2}``, ``{"at": 2, "mass": 0.05, "clearance": 0.5,
        "restitution": 0.6, "friction": 0.01}``. A wall stands where x_at - x_to reaches the gap, with ``side = -1`` where it reaches minus the gap.
    frequency : float
        Of the forces, radians a unit of time.
    highest, accuracy : float
        More than 8 degrees of freedom are reduced: receptances up to `highest` (five times the frequency by default) are kept to this relative accuracy.
    folder : Path, optional
        Where files lie.

    Returns
    -------
    Structure
        States ``x1, v1, ...`` of the degrees of freedom that stay, ``m1, n1, ...`` of modes, ``y1, w1, ...`` of absorbers; parameters ``frequency``,
        ``force_amplitude``, ``wall_gap``, ... (``wall1_gap``, ``wall2_gap`` of several).

    Raises
    ------
    ParameterError
        The sentence names the field, the value and a way out.
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
    kept = sorted(
        {int(e[end]) - 1 for each in elements.values() for e in each for end in ("at", "to") if e.get(end)}
    )
    if not kept:
        raise ParameterError(
            "a structure without forces and contacts does not move: give forces = [{ at = 1, amplitude = 0.1 }]"
        )
    if not (0.0 < accuracy < 1.0 and frequency > 0.0):
        raise ParameterError(
            f"frequency = {frequency:g}, accuracy = {accuracy:g}: expected a frequency above 0 and an accuracy from 0 to 1"
        )
    return _made(
        reduced(matrices[0], matrices[1], matrices[2], kept, highest or MEANT * frequency, accuracy),
        elements,
        frequency,
    )


def structure_again(settings: Mapping[str, Any]) -> Structure:
    """The structure with these settings."""
    kept = settings["structure"]
    m, c, k = (np.array(kept[name]) for name in MATRICES)
    small = Reduced(m, c, k, tuple(kept["kept"]), kept["size"], kept["error"], kept["highest"])
    values = {key: value for key, value in settings.items() if key not in ("name", "structure")}
    return _made(small, kept["elements"], values.get("frequency", 1.0), values)


def _element(kind: str, place: int, given: object, size: int) -> dict[str, float]:
    """An element with all its fields."""
    where, known = f"{kind}s[{place}]", FIELDS[kind]
    if not isinstance(given, Mapping):
        raise ParameterError(f"{where} = {given!r}: expected fields such as {dict.fromkeys(known, 1.0)}")
    for name, value in given.items():
        if name not in known:
            raise ParameterError(
                f"{where}: there is no field {name!r}{did_you_mean(name, known)}; a {kind} has {', '.join(known)}"
            )
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise ParameterError(f"{where}: {name} = {value!r} is no finite number")
    for name, default in known.items():
        if default is None and name not in given:
            raise ParameterError(f"{where}: {name} is missing")
    found = {name: float(given.get(name, default)) for name, default in known.items()}  # type: ignore[arg-type]
    for end in ("at", "to"):
        low = 1 if end == "at" else 0
        if end in found and not (found[end] == int(found[end]) and low <= found[end] <= size):
            raise ParameterError(
                f"{where}: {end} = {found[end]:g} is no degree of freedom; expected {low} to {size}"
            )
    if found.get("to") == found["at"]:
        raise ParameterError(f"{where}: at and to are both {found['at']:g}; to = 0 is the ground")
    if kind == "wall" and math.isnan(found["restitution"]) == math.isnan(found["stiffness"]):
        raise ParameterError(f"{where}: give restitution, of a rigid wall, or stiffness, of an elastic one")
    if kind == "wall" and abs(found["side"]) != 1.0:
        raise ParameterError(f"{where}: side = {found['side']:g}; expected 1 or -1")
    for name in ("mass", "stiffness", "clearance", "harmonic"):
        if not (found.get(name, 1.0) > 0.0 or math.isnan(found[name])):
            raise ParameterError(f"{where}: {name} = {found[name]:g} is out of range; give a number above 0")
    return {name: value for name, value in found.items() if not math.isnan(value)}


class _Rows:
    """Coordinates of a reduced structure by degree of freedom, and its formulas."""

    def __init__(self, small: Reduced, elements: Mapping[str, Sequence[Element]]) -> None:
        self.count, self.elements = len(small.mass), elements
        self.place = {degree + 1: i for i, degree in enumerate(small.kept)}
        self.inverse = np.linalg.inv(small.mass)
        self.spring, self.damper = -self.inverse @ small.stiffness, -self.inverse @ small.damping
        modes = range(1, self.count - len(small.kept) + 1)
        names = [(f"x{d + 1}", f"v{d + 1}") for d in small.kept] + [(f"m{i}", f"n{i}") for i in modes]
        bodies = range(1, len(elements["absorber"]) + 1)
        self.positions = [x for x, _ in names] + [f"y{i}" for i in bodies]
        self.speeds = [v for _, v in names] + [f"w{i}" for i in bodies]
        self.states = (*self.positions, *self.speeds)

    def name(self, kind: str, k: int, field: str) -> str:
        """The parameter that a field of an element is."""
        return f"{kind}{k + 1 if len(self.elements[kind]) > 1 else ''}_{field}"

    def between(self, element: Element) -> np.ndarray:
        """The direction x_at - x_to, shape (count,)."""
        found = np.zeros(self.count)
        found[self.place[int(element["at"])]] = 1.0
        if element.get("to"):
            found[self.place[int(element["to"])]] = -1.0
        return found

    def stretch(self, state: States, direction: np.ndarray, speed: bool = False) -> Plain:
        """x_at - x_to, or its rate."""
        first = len(self.positions) if speed else 0
        return _sum(direction, state[first : first + self.count])


def _sum(factors: np.ndarray, values: Sequence[Plain]) -> Plain:
    total: Plain = 0.0
    for factor, value in zip(factors.tolist(), values):
        if factor:
            total = total + factor * value
    return total


def _made(
    small: Reduced,
    elements: dict[str, list[dict[str, float]]],
    frequency: float,
    values: Mapping[str, float] | None = None,
) -> Structure:
    rows = _Rows(small, elements)
    parameters = {"frequency": frequency} if elements["force"] else {}
    for kind, each in elements.items():
        for k, element in enumerate(each):
            own = {field: value for field, value in element.items() if field not in FIXED}
            parameters |= {
                rows.name(kind, k, field): value for field, value in own.items() if field != "loss" or value
            }
    contacts: list[Contact] = [
        contact for k, wall in enumerate(elements["wall"]) for contact in _wall(rows, k, wall)
    ]
    contacts += [
        _friction(rows.between(f), rows, f"rub{k + 1}", rows.name("friction", k, "limit"), k + 1)
        for k, f in enumerate(elements["friction"])
    ]
    for k, absorber in enumerate(elements["absorber"]):
        contacts += _absorber(rows, k, absorber)
    made = Structure(
        name="structure",
        states=rows.states,
        parameters={**parameters, **(values or {})},
        phase_rate="frequency" if elements["force"] else None,
        motion=_motion(rows, elements),
        contacts=contacts,
        energy=_energy(rows, small, elements),
    )
    made.reduction, made.elements = small, elements
    return made


def _motion(rows: _Rows, elements: Mapping[str, Sequence[Element]]) -> Callable[..., tuple[Plain, ...]]:
    bodies = len(elements["absorber"])

    def motion(state: States, phase: Plain, p: Named, contact: Named) -> tuple[Plain, ...]:
        x, v = state[: rows.count], state[len(rows.positions) : len(rows.positions) + rows.count]
        pushes: list[tuple[np.ndarray, Plain]] = []
        for k, force in enumerate(elements["force"]):
            swing = cos(force["harmonic"] * phase + force["shift"])
            pushes.append((rows.between(force), getattr(p, rows.name("force", k, "amplitude")) * swing))
        for k, wall in enumerate(elements["wall"]):
            if "stiffness" in wall:
                direction = wall["side"] * rows.between(wall)
                pushes.append((-direction, _press(rows, k, wall, state, p) * _pressed(k, wall, contact)))
        for k, friction in enumerate(elements["friction"]):
            pushes.append((rows.between(friction), getattr(contact, f"rub{k + 1}")))
        own = []
        for k, absorber in enumerate(elements["absorber"]):
            drag = getattr(contact, f"floor{k + 1}")
            pushes.append((rows.between(absorber), drag))
            own.append(-drag / getattr(p, rows.name("absorber", k, "mass")))
        rates = []
        for i in range(rows.count):
            total = _sum(rows.spring[i], x) + _sum(rows.damper[i], v)
            for direction, force in pushes:
                factor = float(rows.inverse[i] @ direction)
                total = total + factor * force if factor else total
            rates.append(total)
        first = len(rows.positions)
        return (*v, *state[first + rows.count : first + rows.count + bodies], *rates, *own)

    return motion


def _press(rows: _Rows, k: int, wall: Element, state: States, p: Named) -> Plain:
    """The force with which an elastic wall presses."""
    force = getattr(p, rows.name("wall", k, "stiffness")) * _beyond(rows, k, wall, state, p)
    if wall["loss"]:
        direction = wall["side"] * rows.between(wall)
        force = force + getattr(p, rows.name("wall", k, "loss")) * rows.stretch(state, direction, speed=True)
    return force


def _beyond(rows: _Rows, k: int, wall: Element, state: States, p: Named) -> Plain:
    """How far the structure has gone beyond the gap of a wall."""
    return rows.stretch(state, wall["side"] * rows.between(wall)) - getattr(p, rows.name("wall", k, "gap"))


def _pressed(k: int, wall: Element, contact: Named) -> Plain:
    """1 where an elastic wall presses, else 0."""
    deep = 0.5 * (1 + getattr(contact, f"stop{k + 1}"))
    return deep * (0.5 * (1 + getattr(contact, f"holds{k + 1}"))) if wall["loss"] else deep


def _wall(rows: _Rows, k: int, wall: Element) -> list[Wall | Switch]:
    direction, gap = wall["side"] * rows.between(wall), rows.name("wall", k, "gap")

    def left(state: States, phase: Plain, p: Named) -> Plain:
        return getattr(p, gap) - rows.stretch(state, direction)

    if "restitution" in wall:
        push = dict(zip(rows.speeds, (-rows.inverse @ direction).tolist()))
        return [Wall(f"W{k + 1}", left, push, rows.name("wall", k, "restitution"))]
    deep = Switch(f"stop{k + 1}", lambda state, phase, p: -left(state, phase, p))
    if not wall["loss"]:
        return [deep]
    return [deep, Switch(f"holds{k + 1}", lambda state, phase, p: _press(rows, k, wall, state, p))]


def _friction(direction: np.ndarray, rows: _Rows, name: str, limit: str, number: int) -> DryFriction:
    letters = tuple(f"{letter}{number}" for letter in "tsu")
    return DryFriction(
        name, lambda state, phase, p: rows.stretch(state, direction, speed=True), limit, letters=letters
    )


def _absorber(rows: _Rows, k: int, absorber: Element) -> list[Wall | DryFriction]:
    """Two walls and a floor of an absorber's cavity."""
    direction, mass = rows.between(absorber), rows.name("absorber", k, "mass")
    place, speed = rows.count + k, len(rows.positions) + rows.count + k
    moved = rows.inverse @ direction

    def wall(letter: str, side: int) -> Wall:
        push: dict[str, Any] = dict(zip(rows.speeds, (-side * moved).tolist()))
        push[rows.speeds[place]] = lambda state, phase, p: side / getattr(p, mass)
        clearance = rows.name("absorber", k, "clearance")
        return Wall(
            letter, lambda state, phase, p: getattr(p, clearance) - side * (rows.stretch(state, direction) - state[place]),
            push, rows.name("absorber", k, "restitution"),
        )  # fmt: skip

    number = len(rows.elements["friction"]) + k + 1
    floor = DryFriction(
        f"floor{k + 1}",
        lambda state, phase, p: rows.stretch(state, direction, speed=True) - state[speed],
        rows.name("absorber", k, "friction"),
        letters=tuple(f"{letter}{number}" for letter in "tsu"),
    )
    return [wall(f"L{k + 1}", 1), wall(f"R{k + 1}", -1), floor]


def _energy(rows: _Rows, small: Reduced, elements: Mapping[str, Sequence[Element]]) -> Callable[..., Plain]:
    """Of the structure, its absorbers and its elastic walls: half the stiffness times the square of how deep they are pressed in."""

    def energy(state: States, phase: Plain, p: Named) -> Plain:
        first = len(rows.positions)
        total: Plain = 0.0
        for part, values in (
            (small.stiffness, state[: rows.count]),
            (small.mass, state[first : first + rows.count]),
        ):
            for i, value in enumerate(values):
                total = total + 0.5 * value * _sum(part[i], values)
        for k in range(len(elements["absorber"])):
            total = (
                total
                + 0.5 * getattr(p, rows.name("absorber", k, "mass")) * state[first + rows.count + k] ** 2
            )
        for k, wall in enumerate(elements["wall"]):
            if "stiffness" in wall:
                beyond = _beyond(rows, k, wall, state, p)
                deep = 0.5 * (beyond + sqrt(beyond**2))
                total = total + 0.5 * getattr(p, rows.name("wall", k, "stiffness")) * deep**2
        return total

    return energy
