"""Base of the built-in machines: an absorber between two walls of a cavity.

1. A machine is a frozen dataclass in a file of its own. `table` lists all numbers of its equations, in the order of the compiled
   kernels' parameter vector: name, meaning, unit, symbol and limits (`orbits.machines.parameters`). The fields of the dataclass are
   the parameters that belong to the machine; the others (`amplitude` of the reduced absorber) are given with each orbit.
   Checks, studies and tables use the table.
2. `name` selects kernels and stepper in the native core, and the equations of their reference (`orbits.machines.reference`).
   `moving_cavity` says whether the cavity is an oscillator with states of its own.
3. This base derives everything that follows from the names in the table: walls, friction, losses, mirror images, random starts, and
   `rest`, the motion without events (`orbits.machines.rest`). Names that end in ``_left`` and ``_right`` belong to one side;
   ``slope`` inclines the cavity, ``distance_left`` and ``distance_right`` place its walls.
4. `start_nodes` yields orbits in closed form; `own_measures` names measures besides the common ones (`orbits.flows.native.measures`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from contvines.shared.near_names import did_you_mean, no_parameter
from orbits.machines.measures import COMMON, MEANS
from orbits.machines.parameters import CONTACT_TIME, Limits, Parameter, ParameterError
from orbits.machines.varying import Varying
from orbits.words import Word
from orbits.words.alphabet import shaken

if TYPE_CHECKING:
    from orbits.arguments import Reals
    from orbits.machines.rest import Rest

ONE = np.float64(1.0)


class Model(Varying):
    """Base of the built-in machines; see the top of `orbits.machines.base`."""

    name: str
    flow: str = "native"
    forced: bool = True
    in_cavity: ClassVar[bool] = True
    moving_cavity: ClassVar[bool] = False
    """Whether the cavity is an oscillator, with v and v' in states and nodes; otherwise it moves as v = C sin(Omega tau)."""
    phase_rate: ClassVar[str] = "frequency"
    """Name of the forcing frequency."""
    driven_by: ClassVar[str]
    """Name of the parameter for the strength of the forcing; every orbit needs its value, a machine need not have one."""
    table: ClassVar[tuple[Parameter, ...]]
    default_measure: ClassVar[str] = "B"
    """Default measure of pictures: ``B`` (in a sweep at every impact), or a measure of the whole motion."""
    own_measures: ClassVar[tuple[str, ...]] = ()
    patience: int = 0
    """How often a simulation in search of an orbit may be made four times longer."""
    closed_words: ClassVar[tuple[str, ...]] = ()
    """Words of one forcing period for which `start_nodes` has closed forms."""

    settable: ClassVar[tuple[Parameter, ...]]
    """Parameters that can be given: those of the table, and names that stand for several of them."""

    limits: ClassVar[Mapping[str, Limits]]

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "table" in vars(cls):
            if "settable" not in vars(cls):
                cls.settable = cls.table
            cls.parameter_names = tuple(entry.name for entry in cls.table)
            cls.limits = {entry.name: entry.limits for entry in cls.table}
            cls.node_names = ("phase", "B or w", *(("v", "v_rate") if cls.moving_cavity else ()))
            cls.node = len(cls.node_names)

    @property
    def rest(self) -> Rest:
        """The motion without events."""
        from orbits.machines.rest import Rest

        return Rest(self.name)

    def __new__(cls, *values: object, **options: object) -> Self:
        """Check the names of parameters.

        Raises
        ------
        TypeError
            If a parameter is unknown or missing; the message lists the known names, or the meaning of the missing one.
        """
        if values:
            raise TypeError(
                f"{cls.__name__} takes its parameters by name, as restitution=0.76, not {values[0]!r} alone"
            )
        entries = [entry for entry in fields(cls) if entry.init]  # type: ignore[arg-type]
        names = [entry.name for entry in entries]
        for name in options:
            if name not in names:
                raise TypeError(
                    f"{cls.__name__} has no parameter {name!r}{did_you_mean(name, names)}; it has {', '.join(names)}"
                )
        # copies are constructed without options and filled later
        absent = [
            entry.name
            for entry in entries
            if entry.default is MISSING and options and entry.name not in options
        ]
        if absent:
            meanings = [f"{name} ({cls.parameter(name).meaning})" for name in absent]
            raise TypeError(f"{cls.__name__} needs {' and '.join(meanings)}")
        return super().__new__(cls)

    def __post_init__(self) -> None:
        for entry in self.settable:
            value = getattr(self, entry.name, None)
            if value is not None:
                object.__setattr__(self, entry.name, entry.named(value))
        if self.contact_time is not None:
            object.__setattr__(self, "contact_time", CONTACT_TIME.number(self.contact_time))
        self._check_together()

    def _check_together(self) -> None:
        """Raise ParameterError for values that contradict one another."""

    @classmethod
    def parameter(cls, name: str) -> Parameter:
        """Return the table's entry of a parameter.

        Raises
        ------
        ParameterError
            If the name is unknown.
        """
        found = next((entry for entry in cls.settable if entry.name == name), None)
        if found is None:
            raise ParameterError(no_parameter(name, f"the model {cls.name!r}", cls.parameter_names))
        return found

    @classmethod
    def field_names(cls) -> tuple[str, ...]:
        """Return the parameters that belong to the machine itself; the others are given with each orbit."""
        return tuple(entry.name for entry in fields(cls))  # type: ignore[arg-type]

    @classmethod
    def defaults(cls) -> dict[str, Any]:
        """Return the default of each field: ``...`` if it must be given, None if it may be left to each orbit."""
        return {
            entry.name: ... if entry.default is MISSING else entry.default
            for entry in fields(cls)  # type: ignore[arg-type]
        }

    def vector(self, values: Mapping[str, Any] | None = None) -> np.ndarray:
        """Return the parameter vector, shape (P,); `values` replace or complete the machine's own.

        Raises
        ------
        ParameterError
            If a name is unknown, a value out of range or a needed value missing.
        """
        given = dict(values or {})
        for name in given:
            self.parameter(name)
        result = []
        for entry in self.table:
            value = given.get(entry.name, getattr(self, entry.name, None))
            if value is None:
                raise ParameterError(f"{entry.name} is missing: give a number {entry.limits.text}")
            result.append(entry.number(value))
        return np.array(result)

    def check_value(self, name: str, value: float) -> None:
        """Check a value of one parameter.

        Raises
        ------
        ParameterError
            If the value is impossible; the message names parameter, value and remedy.
        """
        for entry in self.settable:
            if entry.name == name:
                entry.number(value)

    def _own(self) -> dict[str, Any]:
        """Return the fields by name."""
        return {name: getattr(self, name) for name in self.field_names()}

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Measures of its orbits; a peak force only if the contact time is known."""
        names = (*COMMON, *self.own_measures)
        if self.contact_time is None:
            names = tuple(name for name in names if name != "peak_force")
        return names + tuple(mean for mean, name in MEANS.items() if name in names)

    def settings(self, params: np.ndarray | None = None) -> dict[str, Any]:
        """Return the machine's fields by name, ready for JSON; `params` only matter to declared machines."""
        values = self._own()
        return {"name": self.name} | {
            key: values[key] for key in values if key != "contact_time" or values[key]
        }

    def changed(self, **values: object) -> Self:
        """Return the same machine with other values of its fields.

        Raises
        ------
        ParameterError
            If a value is impossible.
        """
        return type(self)(**(self._own() | values))

    # ------------------------------------------------------------------ mechanics
    @classmethod
    def column(cls, params: np.ndarray, name: str) -> Reals:
        """Return entry `name` of a parameter vector, or this column of many vectors."""
        j = cls.parameter_names.index(name)
        return params[j] if params.ndim == 1 else params[..., j]

    def phase_speed(self, params: np.ndarray) -> Reals:
        """Return the rate of the phase, radians per unit of the machine's time; shape of `params` (..., P) without the last axis."""
        return self.column(params, self.phase_rate)

    def shakes(self, name: str) -> bool:
        """Return whether a parameter is the strength of the forcing."""
        return name == self.driven_by

    def unshaken(self, params: np.ndarray) -> tuple[str, str] | None:
        """Return None if the machine is forced; otherwise the parameter with its zero value, and a value that forces the machine."""
        if self.column(params, self.driven_by) != 0.0:
            return None
        return f"{self.driven_by} = 0", f"{self.driven_by} = {self.parameter(self.driven_by).example:g}"

    def has_mirror(self, params: np.ndarray, varying: str | None = None) -> bool:
        """Return whether mirror images of motions are motions of this machine, at these parameters and at all values of `varying`.

        This needs a level cavity, and equal restitution and friction on both sides. Distances of the walls may differ: images are taken about the
        middle between the walls.
        """
        if varying == "slope" or ("slope" in self.parameter_names and self.column(params, "slope") != 0.0):
            return False
        return not any(
            varying in (f"{name}_left", f"{name}_right") or np.not_equal(*self.sides(params, name))
            for name in ("restitution", "friction")
        )

    @classmethod
    def sides(cls, params: np.ndarray, name: str) -> tuple[Any, Any]:
        """Return a parameter of the left and of the right side; a parameter without sides is that of both."""
        if f"{name}_left" in cls.parameter_names:
            return cls.column(params, f"{name}_left"), cls.column(params, f"{name}_right")
        shared = cls.column(params, name)
        return shared, shared

    @classmethod
    def weight(cls, params: np.ndarray) -> Reals:
        """Return g cos(slope), the acceleration that presses the absorber on its floor."""
        gravity = cls.column(params, "gravity")
        return gravity * np.cos(cls.column(params, "slope")) if "slope" in cls.parameter_names else gravity

    @classmethod
    def friction_acceleration(cls, params: np.ndarray) -> float:
        """Return a = (1 + eps) mu g cos(slope), the relative acceleration by friction (dimensionless), for the larger mu of both directions."""
        left, right = cls.sides(params, "friction")
        return float((1.0 + cls.column(params, "mass_ratio")) * max(left, right) * cls.weight(params))

    def frictionless(self, params: np.ndarray) -> bool:
        """Return whether there is no friction, so that turns are no events."""
        return self.friction_acceleration(params) == 0.0

    @classmethod
    def cavity_motion(cls, nodes: np.ndarray, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return v and v' at nodes (m, L, n) with parameter vectors (m, P), each of shape (m, L)."""
        if cls.moving_cavity:
            return nodes[:, :, 2], nodes[:, :, 3]
        amplitude, omega = (
            params[:, cls.parameter_names.index(name), None] for name in (cls.driven_by, cls.phase_rate)
        )
        return amplitude * np.sin(nodes[:, :, 0]), amplitude * omega * np.cos(nodes[:, :, 0])

    @classmethod
    def cavity_speed(cls, node: np.ndarray, params: np.ndarray) -> tuple[float, np.ndarray]:
        """Return v' at a node (n,), and its derivatives by the node's entries, shape (n,)."""
        if cls.moving_cavity:
            return float(node[3]), np.array([0.0, 0.0, 0.0, 1.0])
        speed, phase = (
            float(cls.column(params, cls.driven_by) * cls.column(params, cls.phase_rate)),
            float(node[0]),
        )
        return speed * math.cos(phase), np.array([-speed * math.sin(phase), 0.0])

    @classmethod
    def walls(cls, params: np.ndarray) -> tuple[Any, Any]:
        """Return w at the left and at the right wall; shape of `params` (..., P) without the last axis."""
        if "distance_left" in cls.parameter_names:
            left, right = cls.sides(params, "distance")
            return left, -right
        one = np.ones(params.shape[:-1]) if params.ndim > 1 else ONE
        return one, -one

    def natural_units(self, params: np.ndarray) -> tuple[float, float]:
        if self.moving_cavity:
            return super().natural_units(params)
        left, right = self.walls(params)
        length, rate = (
            float(min(left, -right)),
            float(self.column(params, self.phase_rate)),
        )  # the nearer wall: the other one may be out of reach
        return length if 0.0 < length < math.inf else 1.0, rate if 0.0 < rate < math.inf else 1.0

    def middle(self, params: np.ndarray) -> Reals:
        """Return w in the middle between the walls, about which mirror images are taken."""
        left, right = self.walls(params)
        return 0.5 * (left + right)

    def image(self, word: Word, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
        """Return nodes mirrored about the middle between the walls."""
        image, middle = super().image(word, nodes, params), np.asarray(self.middle(params))
        if middle.any():
            hits = word.codes[: nodes.shape[-2]] < 2
            image[..., 1] += np.where(hits, 0.0, 2.0 * middle[..., np.newaxis])
        return image

    @classmethod
    def restitutions(cls, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return Newton's coefficients of the left and of the right wall."""
        return cls.sides(params, "restitution")

    @classmethod
    def bodies(cls, w: Reals, v: Reals, params: np.ndarray) -> tuple[Any, Any]:
        """Return the displacements q1 of the cavity and q2 of the absorber from w = q1 - q2 and v = q1 + eps q2; velocities likewise.

        Shapes follow `w` and `v`, to which `params` (..., P) is broadcast.
        """
        eps = cls.column(params, "mass_ratio")
        return (v + eps * w) / (1.0 + eps), (v - w) / (1.0 + eps)

    @classmethod
    def relative(cls, cavity: Reals, absorber: Reals, params: np.ndarray) -> tuple[Any, Any]:
        """Return w and v from the displacements of cavity and absorber: the inverse of `bodies`."""
        return cavity - absorber, cavity + cls.column(params, "mass_ratio") * absorber

    @classmethod
    def at_home(cls, codes: np.ndarray, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
        """Return nodes (l, n), centred for a motion without impacts.

        The absorber is shifted so that the mean of w over the nodes is the middle between the walls; q1 does not change.
        """
        if not len(codes) or np.any(codes < 2) or np.any(codes > 4):
            return nodes
        shifted = nodes.copy()
        mean = nodes[:, 1].mean() - 0.5 * float(np.sum(cls.walls(params)))
        shifted[:, 1] -= mean
        if nodes.shape[1] > 2:
            shifted[:, 2] += cls.column(params, "mass_ratio") * mean
        return shifted

    @classmethod
    def friction_loss(cls, steps: np.ndarray, params: np.ndarray) -> np.ndarray:
        """Return mu g cos(slope) times the sliding distance, shape (m,), from displacements w between events (m, L)."""
        left, right = (side[:, None] for side in cls.sides(params, "friction"))
        return (np.where(steps > 0.0, left, right) * np.abs(steps)).sum(axis=1) * cls.weight(params)

    def word(self, text: str | Word, params: np.ndarray) -> Word:
        """Read a word of this machine."""
        return Word.parse(text, frictionless=self.frictionless(params))

    def word_of(self, events: Sequence[str], modes: Sequence[int], params: np.ndarray) -> Word | None:
        """Return the word with these events and modes; None if it is impossible at these parameters."""
        if self.frictionless(params) and not {"L", "R"}.issuperset(events):
            return None
        return Word(tuple(events), tuple(modes), shaken(self.frictionless(params)))

    # ------------------------------------------------------------------ starts
    def start_nodes(self, word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]:
        """Yield nodes of orbits in closed form, if there are any."""
        return iter(())

    def random_nodes(
        self, word: Word, periods: int, params: np.ndarray, generator: np.random.Generator
    ) -> np.ndarray | None:
        """Return random nodes as a guess for Newton's method; None if it would practically never converge."""
        if self.moving_cavity:
            return None
        amplitude, omega = (float(self.column(params, name)) for name in (self.driven_by, self.phase_rate))
        phases = np.sort(generator.uniform(0.0, 2.0 * np.pi * periods, len(word)))
        second = generator.uniform(-0.9, 0.9, len(word))
        for i, letter in enumerate(word.events):
            if letter in "LR":
                sign = 1.0 if letter == "L" else -1.0
                second[i] = sign * generator.uniform(0.0, 1.5) * (1.0 + amplitude) * omega
        return np.column_stack([phases, second])

    def random_start(
        self, params: np.ndarray, generator: np.random.Generator, size: float = 1.0
    ) -> dict[str, float]:
        """Return a random state, as `orbits.simulation.simulate` takes it."""
        start = {
            "phase": generator.uniform(0.0, 2.0 * np.pi),
            "w": generator.uniform(-0.95, 0.95),
            "w_rate": generator.uniform(-2.0, 2.0),
        }
        left, right = (float(wall) for wall in self.walls(params))
        reach = min(max(left, -right), 10.0 * min(left, -right))  # a wall far away does not set the scale
        low, high = max(right, -reach), min(left, reach)
        start["w"] = 0.5 * (low + high) + 0.5 * (high - low) * start["w"]
        if self.moving_cavity:
            start |= {"v": generator.uniform(-1.0, 1.0), "v_rate": generator.uniform(-1.0, 1.0)}
        return start
