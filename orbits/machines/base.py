"""What every machine offers.

The contract, in words
----------------------
1. A machine is a frozen dataclass with a folder of its own. `table` lists all numbers that its maps depend on, in the order of the
   compiled kernels' parameter vector: name, meaning, unit, symbol and limits (`orbits.machines.parameters`). Its fields are those
   of them that belong to the machine; a name that is no field (`amplitude` of the reduced absorber) is given with each orbit.
   Studies, refusals and tables are made from the table.
2. `node_names` names the unknowns of an event; the first is the phase, the second the absorber's velocity B+ after an impact and
   its position w at the other events.
3. `kernels` is the module of compiled maps with `linearise`, `margins` and `unpin` (signatures: `orbits.machines.absorber.maps`).
4. `stepper` is the module of the compiled event-driven simulation (contract: `orbits.machines.stepping`).
5. `has_mirror` says whether the mirror image of a motion about the middle between the walls (L and R change places, all unknowns
   but the phase change sign, positions counted from that middle, half a forcing period later) is a motion of the same machine. Nothing is solved on half a word, and no image is identified with a
   motion, unless it says so.
6. `cavity_motion`, `walls` and `restitutions` give what measures and event tables need; `own_measures` names further measures
   and `measure_own` computes them.
7. `rest` is the motion without events: its linear equations, the reserve of friction, its multipliers (`orbits.machines.rest`).
8. `start_nodes` yields closed forms to start from, `random_nodes` guesses, `random_start` states for the simulator.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, fields
from types import ModuleType
from typing import Any, ClassVar, Self

import numpy as np

from contvines.shared.near_names import did_you_mean, no_parameter
from orbits.machines.parameters import Limits, Parameter, ParameterError
from orbits.machines.rest import Rest
from orbits.machines.varying import Varying
from orbits.words import Word
from orbits.words.alphabet import shaken

ONE = np.float64(1.0)


class Model(Varying):
    """Base of the machines; see the contract at the top of `orbits.machines.base`."""

    name: ClassVar[str]
    flow: ClassVar[str] = "native"
    """What happens between two events: a name in `orbits.flows.catalogue`."""
    forced: ClassVar[bool] = True
    phase_rate: ClassVar[str] = "frequency"
    """The parameter that is the forcing's frequency."""
    table: ClassVar[tuple[Parameter, ...]]
    node_names: ClassVar[tuple[str, ...]]
    default_parameter: ClassVar[str]
    default_measure: ClassVar[str] = "B"
    own_measures: ClassVar[tuple[str, ...]] = ()
    swept_measure: ClassVar[str] = "B"
    """What the picture of a sweep shows: ``B`` at every impact, or a measure of the whole motion."""
    driven_by: ClassVar[str]
    """The parameter that drives the machine: an orbit must have it, a machine need not."""
    patience: ClassVar[int] = 0
    """How often a start that is looked for by simulation may be simulated four times longer."""
    closed_words: ClassVar[tuple[str, ...]] = ()
    """Words of one forcing period of whose orbits `start_nodes` has closed forms."""
    rest: ClassVar[Rest]
    moving_cavity: ClassVar[bool] = False
    """Whether the cavity has a motion of its own, v and v' in the state; else it moves as prescribed."""

    settable: ClassVar[tuple[Parameter, ...]]
    """What may be given: the table, and names that stand for several of its numbers."""

    # derived from the table
    node: ClassVar[int]
    parameter_names: ClassVar[tuple[str, ...]]
    limits: ClassVar[Mapping[str, Limits]]

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "table" in vars(cls):
            if "settable" not in vars(cls):
                cls.settable = cls.table
            cls.parameter_names = tuple(entry.name for entry in cls.table)
            cls.limits = {entry.name: entry.limits for entry in cls.table}
        if "node_names" in vars(cls):
            cls.node = len(cls.node_names)

    def __new__(cls, *values: Any, **options: Any) -> Self:
        """A machine; a name that it does not have is refused with those that it has, one that is missing with its meaning."""
        if values:
            raise TypeError(
                f"{cls.__name__} takes its parameters by name, as restitution=0.76, not {values[0]!r} alone"
            )
        own = [entry for entry in fields(cls) if entry.init]  # type: ignore[arg-type]
        known = [entry.name for entry in own]
        for name in options:
            if name not in known:
                raise TypeError(
                    f"{cls.__name__} has no parameter {name!r}{did_you_mean(name, known)}; it has {', '.join(known)}"
                )
        # copies are made without any, and filled later
        absent = [
            entry.name for entry in own if entry.default is MISSING and options and entry.name not in options
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
        self._check_together()

    def _check_together(self) -> None:
        """Refuse values that make no sense together."""

    @property
    def kernels(self) -> ModuleType:
        """The module of compiled maps."""
        raise TypeError(f"{type(self).__name__} has no kernels")

    @classmethod
    def stepper(cls) -> ModuleType:
        """The module of the compiled event-driven simulation."""
        raise TypeError(f"{cls.__name__} has no stepper")

    @classmethod
    def parameter(cls, name: str) -> Parameter:
        """The entry of the table with this name.

        Raises
        ------
        ParameterError
            If there is none.
        """
        for entry in cls.settable:
            if entry.name == name:
                return entry
        raise ParameterError(no_parameter(name, f"the model {cls.name!r}", cls.parameter_names))

    @classmethod
    def field_names(cls) -> tuple[str, ...]:
        """Parameters that belong to the machine itself; the others are given with each orbit."""
        return tuple(entry.name for entry in fields(cls))  # type: ignore[arg-type]

    @classmethod
    def defaults(cls) -> dict[str, Any]:
        """Default of each field: ``...`` where it must be given, None where it may be left to each orbit."""
        return {
            entry.name: ... if entry.default is MISSING else entry.default
            for entry in fields(cls)  # type: ignore[arg-type]
        }

    def vector(self, values: Mapping[str, Any] | None = None) -> np.ndarray:
        """The parameter vector, shape (P,), with `values` in place of or beside the machine's own.

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

    @classmethod
    def column(cls, params: np.ndarray, name: str) -> Any:
        """Entry `name` of a parameter vector, or that column of many of them."""
        j = cls.parameter_names.index(name)
        return params[j] if params.ndim == 1 else params[..., j]

    @classmethod
    def phase_speed(cls, params: np.ndarray) -> Any:
        """How fast the phase grows, in radians per unit of the machine's own time; shapes follow `params` (..., P)."""
        return cls.column(params, cls.phase_rate)

    def check_value(self, name: str, value: float) -> None:
        """Refuse a value that a parameter cannot have.

        Raises
        ------
        ParameterError
            Naming the parameter, the value and what would do.
        """
        for entry in self.settable:
            if entry.name == name:
                entry.number(value)

    # ------------------------------------------------------------------ mechanics
    def shakes(self, name: str) -> bool:
        """Whether a parameter says how strongly the machine is shaken."""
        return name == self.driven_by

    def unshaken(self, params: np.ndarray) -> tuple[str, str] | None:
        """Where nothing shakes the machine: the parameter that says so with its value, and one that would do; else None."""
        if self.column(params, self.driven_by) != 0.0:
            return None
        return f"{self.driven_by} = 0", f"{self.driven_by} = {self.parameter(self.driven_by).example:g}"

    def has_mirror(self, params: np.ndarray, varying: str | None = None) -> bool:
        """Whether mirror images are motions of this machine, at these parameters and however `varying` varies."""
        return True

    @classmethod
    def friction_acceleration(cls, params: np.ndarray) -> float:
        """a = (1 + eps) mu g cos(slope), the friction's relative acceleration (dimensionless)."""
        eps, mu, g = (float(cls.column(params, name)) for name in ("mass_ratio", "friction", "gravity"))
        return (1.0 + eps) * mu * g * float(cls.upright(params))

    @classmethod
    def upright(cls, params: np.ndarray) -> Any:
        """cos(slope), the share of gravity that presses the absorber on its floor; 1 where there is no slope."""
        return np.cos(cls.column(params, "slope")) if "slope" in cls.parameter_names else 1.0

    def frictionless(self, params: np.ndarray) -> bool:
        """Whether turns are no events."""
        return self.friction_acceleration(params) == 0.0

    @classmethod
    def cavity_motion(cls, nodes: np.ndarray, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """v and v' at nodes (m, L, n) with parameter vectors (m, P), each of shape (m, L)."""
        raise TypeError(f"{cls.__name__} has no cavity")

    @classmethod
    def cavity_speed(cls, node: np.ndarray, params: np.ndarray) -> tuple[float, np.ndarray]:
        """v' at a node (n,), and its derivatives with respect to the node's entries, shape (n,)."""
        raise TypeError(f"{cls.__name__} has no cavity")

    @classmethod
    def walls(cls, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """w at the left and at the right wall; shapes follow `params` (..., P)."""
        one: Any = np.ones(params.shape[:-1]) if params.ndim > 1 else ONE
        return one, -one

    @classmethod
    def middle(cls, params: np.ndarray) -> Any:
        """w in the middle between the walls, about which mirror images are taken; shapes follow `params` (..., P)."""
        left, right = cls.walls(params)
        return 0.5 * (left + right)

    @classmethod
    def image(cls, codes: np.ndarray, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
        """Nodes (..., L, n) of events `codes` mirrored about the middle between the walls, at the same phases."""
        image = -nodes
        image[..., 0] = nodes[..., 0]
        middle = np.asarray(cls.middle(params))
        if middle.any():
            image[..., 1] += np.where(codes < 2, 0.0, 2.0 * middle[..., np.newaxis])
        return image

    @classmethod
    def restitutions(cls, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Newton's coefficients of the left and of the right wall."""
        r = cls.column(params, "restitution")
        return r, r

    @classmethod
    def bodies(cls, w: Any, v: Any, params: np.ndarray) -> tuple[Any, Any]:
        """Displacements q1 of the cavity and q2 of the absorber from w = q1 - q2 and v = q1 + eps q2; velocities likewise.

        Shapes follow `w` and `v`, against which `params` (..., P) is broadcast.
        """
        eps = cls.column(params, "mass_ratio")
        return (v + eps * w) / (1.0 + eps), (v - w) / (1.0 + eps)

    @classmethod
    def relative(cls, cavity: Any, absorber: Any, params: np.ndarray) -> tuple[Any, Any]:
        """w and v from the displacements of cavity and absorber, the inverse of `bodies`."""
        return cavity - absorber, cavity + cls.column(params, "mass_ratio") * absorber

    @classmethod
    def at_home(cls, codes: np.ndarray, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
        """Nodes (l, n); of a motion without impacts with the absorber moved so that the mean of w is the middle between the walls (q1 stays)."""
        if not len(codes) or np.any(codes < 2) or np.any(codes > 4):
            return nodes
        moved = nodes.copy()
        mean = nodes[:, 1].mean() - 0.5 * float(np.sum(cls.walls(params)))
        moved[:, 1] -= mean
        if nodes.shape[1] > 2:
            moved[:, 2] += cls.column(params, "mass_ratio") * mean
        return moved

    @classmethod
    def impact_loss(cls, restitution: Any, speed: Any, params: np.ndarray) -> Any:
        """Energy that impacts of these relative speeds (m, L) take, (1 - r^2) w'^2 / (2 (1 + eps)), per unit of the absorber's mass."""
        eps = cls.column(params, "mass_ratio")[..., np.newaxis]
        return (1.0 - restitution**2) * speed**2 / (2.0 * (1.0 + eps))

    @classmethod
    def friction_loss(cls, steps: np.ndarray, params: np.ndarray) -> np.ndarray:
        """mu g cos(slope) times the path slid, from the displacements w between events (m, L); shape (m,)."""
        return (
            cls.column(params, "friction")
            * cls.column(params, "gravity")
            * cls.upright(params)
            * np.abs(steps).sum(axis=1)
        )

    # ------------------------------------------------------------------ starts and measures
    def word(self, text: str | Word, params: np.ndarray) -> Word:
        """Read a word of this machine."""
        return Word.parse(text, frictionless=self.frictionless(params))

    def word_of(self, events: Sequence[str], modes: Sequence[int], params: np.ndarray) -> Word | None:
        """The word with these events and modes; None if the machine has none such at these parameters."""
        if self.frictionless(params) and not {"L", "R"}.issuperset(events):
            return None
        return Word(tuple(events), tuple(modes), shaken(self.frictionless(params)))

    def start_nodes(self, word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]:
        """Nodes to start from in closed form, where there are any."""
        return iter(())

    def random_nodes(
        self, word: Word, periods: int, params: np.ndarray, generator: np.random.Generator
    ) -> np.ndarray | None:
        """Nodes at random from which Newton's method may find an orbit; None if that is hopeless."""
        return None

    def random_start(
        self, params: np.ndarray, generator: np.random.Generator, size: float = 1.0
    ) -> dict[str, float]:
        """A state at random, as `orbits.simulation.simulate` takes it."""
        return {
            "phase": generator.uniform(0.0, 2.0 * np.pi),
            "w": generator.uniform(-0.95, 0.95),
            "w_rate": generator.uniform(-2.0, 2.0),
        }

    def measure_own(
        self, wanted: Sequence[str], word: Word, periods: int, nodes: np.ndarray, params: np.ndarray
    ) -> dict[str, np.ndarray]:
        """The machine's own measures of many orbits with one word."""
        raise KeyError(f"the model {self.name!r} has no measures of its own")

    def settings(self, params: np.ndarray | None = None) -> dict[str, Any]:
        """The machine's own fields by name, ready for JSON; those of a page are its parameters, at `params` where they are given."""
        return {"name": self.name} | {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]

    def changed(self, **values: Any) -> Self:
        """The same machine with other values."""
        own = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return type(self)(**(own | values))
