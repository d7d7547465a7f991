"""Built-in machines with physical quantities as parameters: kilograms, millimetres and hertz outside, dimensionless numbers inside.

Equations and simulator use the machine's dimensionless numbers; the scales are appended to the parameter vector. The varying parameter is
a quantity in the unit in which it was given, and may change several numbers (`orbits.machines.parameters`). Measures are multiplied by the
size of one dimensionless unit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, ClassVar

import numpy as np

from contvines.shared.motions import BAND
from orbits.machines.base import Model
from orbits.machines.measures import KINDS
from orbits.machines.names import model_class
from orbits.machines.parameters import POSITIVE, Parameter, along, products
from orbits.machines.physical import units
from orbits.machines.physical.quantities import Basis, Quantity, QuantityError, independent, near_quantity
from orbits.machines.physical.tables import TABLES, Table, check_ratios

CONTACT = Quantity("contact_time", "s", "1 ms", {}, (1e-7, 1.0), "the duration of an impact")


def tables(model: type[Model]) -> Table:
    """Return the quantities of a machine.

    Raises
    ------
    QuantityError
        If it has none.
    """
    if model.name not in TABLES:
        raise QuantityError(
            f'units = "si": the machine {model.name!r} has no physical quantities of its own; leave units out'
        )
    return TABLES[model.name]


def physical(name: str, given: Mapping[str, Any], unusual: bool = False) -> Physical:
    """Return the machine called `name` with these quantities.

    Parameters
    ----------
    name : str
        Name in studies.
    given : mapping
        Quantities as text, ``{"half_width": "15 mm", ...}``; those without a unit may be numbers.
    unusual : bool
        Allow values far from those of real machines.

    Returns
    -------
    Model
        Of the class for `name`; its quantities in `amounts` have the units in which they were given.

    Raises
    ------
    QuantityError
        If a quantity is unknown, missing, of the wrong dimension, implausible, or given twice.
    """
    base = model_class(name)
    table = tables(base)
    quantities = table.quantities
    counted: dict[str, tuple[float, str]] = {}
    values: dict[str, float] = {}
    for key, value in given.items():
        quantity = CONTACT if key == CONTACT.name else quantities.get(key)
        if quantity is None:
            raise QuantityError(
                f"{key} = {value!r}: the machine {name!r} has no such quantity{near_quantity(key, quantities)}; "
                f"it has {', '.join(quantities)}"
            )
        if isinstance(value, str) and key in base.parameter_names:
            value = base.parameter(key).words.get(value, value)
        counted[key] = units.read(quantity, value)
        values[key] = units.si(quantity, *counted[key])
        units.check_limits(quantity, *counted[key], base.limits)
        if not unusual:
            units.check_usual(quantity, values[key], f"{key} = {value!r}")
    contact_time = values.pop(CONTACT.name, None)
    chosen = independent(quantities, values)
    values = table.completed(values)
    for quantity in chosen:
        unit = units.unit_of(quantity)
        if quantity.name in values:
            counted.setdefault(quantity.name, (values[quantity.name] / units.si(quantity, 1.0, unit), unit))
            continue
        if quantity.default is None:
            others = [
                q.name for q in quantities.values() if q.choice == quantity.choice and q is not quantity
            ]
            others_text = f" (or {', '.join(others)} instead)" if others else ""
            example = f'"{quantity.example}"' if quantity.unit else quantity.example
            raise QuantityError(f"{quantity.name} is missing{others_text}: for example {example}")
        counted[quantity.name] = units.read(quantity, quantity.default)
    return _assembled(base, chosen, counted, unusual, contact_time)


def _assembled(
    base: type[Model],
    chosen: tuple[Quantity, ...],
    counted: Mapping[str, tuple[float, str]],
    unusual: bool,
    contact_time: float | None,
) -> Physical:
    """Return the machine with these quantities, each given in a unit."""
    units_given = tuple(counted[q.name][1] for q in chosen)
    sizes = np.array([units.si(q, 1.0, unit) for q, unit in zip(chosen, units_given)])
    basis = Basis(chosen, (*base.parameter_names, *tables(base).scales), sizes)
    amounts = np.array([counted[q.name][0] for q in chosen])
    numbers = dict(zip(basis.numbers, products(basis.law, amounts).tolist()))
    machine = _machine_from(base, numbers, basis, amounts, units_given, unusual, contact_time)
    if not unusual:
        texts = {q.name: "{:.6g} {}".format(*counted[q.name]).rstrip() for q in chosen}
        check_ratios(numbers, texts)
    return machine


def _machine_from(
    base: type[Model],
    numbers: Mapping[str, float],
    basis: Basis,
    counts: np.ndarray,
    said: tuple[str, ...],
    unusual: bool,
    contact_time: float | None,
) -> Physical:
    """Return the machine with these numbers, and a record of the given quantities."""
    cls = _class_of(base)
    field_names = cls.field_names()
    machine = cls(
        contact_time=contact_time, **{name: numbers[name] for name in numbers if name in field_names}
    )
    loose = {name: value for name, value in numbers.items() if name not in field_names}
    for name, value in {
        "basis": basis, "counts": counts, "said": said, "loose": loose, "unusual": unusual, "base": base,
    }.items():  # fmt: skip
        object.__setattr__(machine, name, value)
    return machine


@cache
def _class_of(base: type[Model]) -> type[Physical]:
    """Return the machine's class with the scales among its fields."""
    scales = tables(base).scales
    body: dict[str, Any] = {
        "__annotations__": dict.fromkeys(scales, float),
        "__module__": __name__,
        "__doc__": base.__doc__,
        "table": (*base.table, *(Parameter(name, "a scale", POSITIVE, name) for name in scales)),
        "tables": tables(base),
    }
    new_class = type(f"Physical{base.__name__}", (Physical, base), body)
    return dataclass(frozen=True, kw_only=True)(new_class)


class Physical(Model):
    """Base of machines with physical quantities: the methods that differ from the dimensionless machine; see the top of this file."""

    tables: ClassVar[Table]
    base: type[Model]
    basis: Basis
    counts: np.ndarray
    said: tuple[str, ...]
    loose: dict[str, float]
    unusual: bool

    # ------------------------------------------------------------------ quantities
    @property
    def amount_names(self) -> tuple[str, ...]:
        return self.basis.names

    def amounts(self, params: np.ndarray) -> np.ndarray:
        return self.basis.amounts_of(np.asarray(params, dtype=float))

    @property
    def law(self) -> np.ndarray:
        return self.basis.law

    @property
    def quantities(self) -> dict[str, float]:
        """The machine's quantities by name, counted in `units`."""
        return dict(zip(self.amount_names, (float(value) for value in self.counts)))

    @property
    def units(self) -> dict[str, str]:
        """Units of quantities and measures by name; plain numbers have none."""
        return self._units

    @cached_property
    def _units(self) -> dict[str, str]:
        gauges, found = self.tables.gauges, dict(zip(self.amount_names, self.said))
        for name in (*self.measure_names, *(BAND if self.moving_cavity else ())):
            kind = KINDS.get(name, "")
            found.setdefault(
                name, "rad" if kind == "angle" else units.unit_of(gauges[kind]) if kind in gauges else ""
            )
        if self.contact_time is not None:
            found[CONTACT.name] = CONTACT.unit
        return {name: unit for name, unit in found.items() if unit}

    def described(self, params: np.ndarray) -> dict[str, Any]:
        """Return the quantities with their units, and the numbers behind them."""
        amounts = dict(zip(self.amount_names, (float(v) for v in self.amounts(params))))
        numbers = self.named(params)
        return {"parameters": amounts, "units": self.units, "numbers": numbers}

    def gauge(self, kind: str, params: np.ndarray) -> np.ndarray | float:
        """Return one dimensionless unit of a kind of measure in the shown unit; params (..., P), result (...)."""
        quantity = self.tables.gauges.get(kind)
        if quantity is None:
            return 1.0
        powers = np.array([quantity.powers.get(name, 0.0) for name in self.basis.numbers])
        size = units.size(units.unit_of(quantity), quantity.unit)
        assert size
        return np.prod(np.asarray(params, dtype=float) ** powers, axis=-1) / size

    def gauges(self, names: Sequence[str], params: np.ndarray) -> dict[str, tuple[float, str]]:
        """Return the size of one of these coordinates in the shown unit, and this unit."""
        kinds = {name: "velocity" if name.endswith("_rate") else "length" for name in names}
        return {
            name: (float(self.gauge(kind, params)), units.unit_of(self.tables.gauges[kind]))
            for name, kind in kinds.items()
        }

    # ------------------------------------------------------------------ parameters
    def vector(self, values: Mapping[str, Any] | None = None) -> np.ndarray:
        """Return the parameter vector; text is a quantity (``frequency="7.9 Hz"``), a number is one of the dimensionless numbers."""
        given = dict(values or {})
        texts = [name for name in given if isinstance(given[name], str) and name in self.tables.quantities]
        if texts:
            return self.with_(**{name: given.pop(name) for name in texts}).vector(given)
        return super().vector({**self.loose, **given})

    def vector_at(self, name: str, value: float, values: Mapping[str, Any] | None = None) -> np.ndarray:
        """Return `vector` with quantity `name` at `value`, in its unit in `units`."""
        params = self.vector(values)
        moved = along(self.path(name, params), params, value)
        return super().vector({**self.loose, **self.named(moved)})

    def check_value(self, name: str, value: float) -> None:
        """Check a value of quantity `name`, in its unit in `units`; for other names, one of the dimensionless numbers."""
        quantity = self.tables.quantities.get(name)
        if quantity is None:
            super().check_value(name, value)
            return
        unit = self.units.get(name) or units.unit_of(quantity)
        units.read(quantity, units.text(value, unit))
        units.check_limits(quantity, value, unit, self.base.limits)

    def check_at(self, name: str, value: float) -> None:
        """Check that a value of quantity `name`, in its unit in `units`, is plausible together with the others.

        Raises
        ------
        QuantityError
        """
        if self.unusual:
            return
        texts = {**self._texts, name: units.text(value, self.units.get(name, ""))}
        numbers = self.named(self.vector_at(name, value))
        check_ratios(numbers, {key: str(text) for key, text in texts.items()}, wide=True)

    def shakes(self, name: str) -> bool:
        return name in self.tables.quantities and self.driven_by in self.tables.quantities[name].powers

    def unshaken(self, params: np.ndarray) -> tuple[str, str] | None:
        if super().unshaken(params) is None:
            return None
        quantity = next(q for q in self.basis.quantities if self.shakes(q.name))
        return f"{quantity.name} = 0 {self.units[quantity.name]}", f'{quantity.name} = "{quantity.example}"'

    def with_(self, **changes: str | float) -> Physical:
        """Return the machine with other quantities, as text or as numbers in their units in `units`."""
        quantities = self.tables.quantities
        groups = {quantities[name].choice for name in changes if name in quantities}
        own = {
            n: value
            for n, value in self._texts.items()
            if n not in quantities or quantities[n].choice not in groups
        }
        counted = {
            name: units.text(float(value), self.units[name])
            if not isinstance(value, str) and self.units.get(name)
            else value
            for name, value in changes.items()
        }
        return physical(self.name, own | counted, self.unusual)

    def given_by(self, name: str) -> Physical:
        """Return the same machine with quantity `name` in place of the equivalent one.

        Raises
        ------
        ParameterError
            If the machine has no such quantity.
        """
        quantities = self.tables.quantities
        if name in self.amount_names or name not in quantities:
            self.place_of(name)
            return self
        chosen = tuple(
            quantities[name] if q.choice == quantities[name].choice else q for q in self.basis.quantities
        )
        params = self.vector({})
        ones = Basis(chosen, self.basis.numbers, np.ones(len(chosen)))
        units_ = {q.name: self.units.get(q.name) or units.unit_of(q) for q in chosen}
        counted = {
            q.name: (float(value) / units.si(q, 1.0, units_[q.name]), units_[q.name])
            for q, value in zip(chosen, ones.amounts_of(params))
        }
        given = dict(zip(self.amount_names, zip(self.quantities.values(), self.said)))
        counts = {**counted, **given}
        return _assembled(self.base, chosen, counts, self.unusual, self.contact_time)

    @property
    def _texts(self) -> dict[str, Any]:
        values = self.quantities | ({CONTACT.name: self.contact_time} if self.contact_time else {})
        return {name: units.text(value, self.units.get(name, "")) for name, value in values.items()}

    def settings(self, params: np.ndarray | None = None) -> dict[str, Any]:
        """Return the machine's quantities as text, ready for JSON."""
        return {"name": self.name, "units": "si", "unusual": self.unusual, **self._texts}

    def changed(self, **values: object) -> Physical:
        """Return the same machine with other values of its dimensionless numbers."""
        numbers = self.named(self.vector(values))
        counts = self.basis.amounts_of(np.array([*numbers.values()]))
        return _machine_from(
            self.base, numbers, self.basis, counts, self.said, self.unusual, self.contact_time
        )

    def __reduce__(self) -> tuple[Callable, tuple]:
        return physical_again, (self.settings(),)


def physical_again(settings: Mapping[str, Any]) -> Physical:
    """Return the machine with these settings from a file."""
    values = {key: value for key, value in settings.items() if key not in ("name", "units", "unusual")}
    return physical(settings["name"], values, bool(settings.get("unusual", False)))
