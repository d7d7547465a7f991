"""What every machine offers.

The contract, in words
----------------------
1. A machine is a frozen dataclass in a file of its own. `table` lists all numbers that its maps depend on, in the order of the
   compiled kernels' parameter vector: name, meaning, unit, symbol and limits (`orbits.machines.parameters`). Its fields are those
   of them that belong to the machine; a name that is no field (`amplitude` of the reduced absorber) is given with each orbit.
   Studies, refusals and tables are made from the table.
2. `name` is that of its flow: of its kernels and stepper in the native core, and of its numbers in their reference (`orbits.machines.reference`).
   `moving_cavity` says whether the cavity has a motion of its own.
3. All that follows from the names in the table is composed once (`orbits.machines.mechanics`): walls, friction, losses, mirror images, random starts.
   So is `rest`, the motion without events (`orbits.machines.rest`).
4. `start_nodes` yields closed forms to start from; `own_measures` names what is measured beside the common ones (`orbits.flows.native.measures`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any, ClassVar, Self

import numpy as np

from contvines.shared.near_names import did_you_mean, no_parameter
from orbits.machines.mechanics import Mechanics
from orbits.machines.parameters import CONTACT_TIME, Limits, Parameter, ParameterError
from orbits.machines.rest import Rest


class Model(Mechanics):
    """Base of the machines; see the contract at the top of `orbits.machines.base`."""

    name: str
    flow: str = "native"
    """What happens between two events: a name in `orbits.flows.catalogue`."""
    forced: bool = True
    in_cavity: ClassVar[bool] = True
    table: ClassVar[tuple[Parameter, ...]]
    default_measure: ClassVar[str] = "B"
    """What pictures show where no measure is named: ``B`` (in a sweep at every impact), or a measure of the whole motion."""
    own_measures: ClassVar[tuple[str, ...]] = ()
    patience: int = 0
    """How often a start that is looked for by simulation may be simulated four times longer."""
    closed_words: ClassVar[tuple[str, ...]] = ()
    """Words of one forcing period of whose orbits `start_nodes` has closed forms."""

    settable: ClassVar[tuple[Parameter, ...]]
    """What may be given: the table, and names that stand for several of its numbers."""

    # derived from the table
    default_parameter: str
    node_names: tuple[str, ...]
    node: int
    rest: ClassVar[Rest]
    parameter_names: tuple[str, ...]
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
            cls.rest = Rest(cls.name)

    def __new__(cls, *values: object, **options: object) -> Self:
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
        if self.contact_time is not None:
            object.__setattr__(self, "contact_time", CONTACT_TIME.number(self.contact_time))
        self._check_together()

    def _check_together(self) -> None:
        """Refuse values that make no sense together."""

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

    def check_value(self, name: str, value: float) -> None:
        """Refuse a value that a parameter cannot have.

        Raises
        ------
        ParameterError
            Naming the parameter, the value and a way out.
        """
        for entry in self.settable:
            if entry.name == name:
                entry.number(value)

    def settings(self, params: np.ndarray | None = None) -> dict[str, Any]:
        """The machine's own fields by name, ready for JSON; those of a declared machine are its parameters, at `params` where they are given."""
        own = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {"name": self.name} | {key: own[key] for key in own if key != "contact_time" or own[key]}

    def changed(self, **values: object) -> Self:
        """The same machine with other values of its fields.

        Raises
        ------
        ParameterError
            If a value is one that the parameter cannot have.
        """
        own = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return type(self)(**(own | values))
