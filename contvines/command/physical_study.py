"""Studies in physical units: `units = "si"`, and quantities as texts.

The quantities define a machine (`orbits.machines.physical`). Intervals and values of a varied quantity are converted to numbers in the
unit in which the machine's quantity is given; the rest is treated as in other studies.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from orbits.machines.names import model_class
from orbits.machines.physical import units
from orbits.machines.physical.machine import Physical, physical, tables
from orbits.machines.physical.quantities import Quantity, QuantityError, near_quantity

from .schema import StudySections
from .study_data import Sort, Study, built, refuse, refused, validated, wrong_guess, wrong_intervals

OWN = ("name", "units", "unusual", "contact_time")
SAID = ("word", "periods", "guess")


def read_physical(data: dict[str, Any], path: Path) -> Study:
    """Check a study in physical units.

    Raises
    ------
    StudyError
        If a value is invalid.
    """
    model, start = data.get("model"), data.get("start", {})
    plain = {key: value for key, value in data.items() if key not in ("units", "model")}
    machine, wrong = None, []

    def number(name: str | None, given: object, place: str, i: int) -> object:
        if machine is not None and name in machine.tables.quantities:
            return number_of(machine.given_by(name), name, given, f"{place}[{i}]")
        return float(i)  # why there is no such quantity is told already

    if isinstance(model, dict) and isinstance(start, dict):
        plain["start"] = {key: value for key, value in start.items() if key in SAID}
        machine, wrong = _machine(data.get("units", model.get("units")), model, start, plain)
        plain = in_numbers(plain, number, None if machine is None else machine.units, wrong)
    file = validated(StudySections, plain, wrong)
    if machine is None and not wrong:
        wrong = ["the section [model] is missing; it holds the machine's name and its quantities."]
    refuse(wrong)
    assert machine is not None
    own, name = machine.quantities, file.continue_.parameter
    wrong = wrong_intervals(file, own.get(name), lambda name, value: "", machine.units.get(name, ""))
    refuse([*wrong, *wrong_guess(file.start.guess, machine)])
    return built(Study.of(path, Sort.PHYSICAL, machine.name, own, file, model=machine))


def _machine(
    units_given: object, model: dict[str, Any], start: dict[str, Any], others: dict[str, Any]
) -> tuple[Physical | None, list[str]]:
    """Return the machine of `[model]` and `[start]` (None if it cannot be made) and all errors.

    The quantity that `[continue]` varies is in the unit of its interval.
    """
    if units_given != "si":
        return None, [f'units = {units_given!r} is unknown; use "si", or leave it out.']
    name = str(model.get("name"))
    try:
        quantities = tables(model_class(name)).quantities
    except ValueError as error:
        return None, [f"[model] {error}."]
    wrong = [
        f"[{section}] {key} = {value!r}: there is no such quantity{near_quantity(key, [*quantities, *extra])}; "
        f"known are {', '.join([*extra, *quantities])}."
        for section, values, extra in (("model", model, OWN), ("start", start, SAID))
        for key, value in values.items()
        if key not in quantities and key not in extra
    ]
    varied = {section: _parameter(others.get(section)) for section in ("continue", "chart")}
    wrong += [
        f"[{section}] parameter = {over!r}: the model {name!r} has no such quantity{near_quantity(over, quantities)}; it has {', '.join(quantities)}."
        for section, over in varied.items()
        if over is not None and over not in quantities
    ]
    over = quantities.get(varied["continue"] or "")
    said_already = {quantities[key].choice for key in (*model, *start) if key in quantities}
    if over is not None and "word" not in start and over.choice not in said_already:
        start = {**start, over.name: _middle(over, others["continue"])}
    # quantities in [start] replace those of the same choice in [model]
    groups = {quantities[key].choice for key in start if key in quantities}
    places = {key: "model" for key in model if key in quantities and quantities[key].choice not in groups}
    places |= {key: "start" for key in start if key in quantities}
    given = {key: (model if section == "model" else start)[key] for key, section in places.items()}
    given |= {key: model[key] for key in ("contact_time",) if key in model}
    unusual = model.get("unusual", False)
    if not isinstance(unusual, bool):
        wrong.append(f"[model] unusual = {unusual!r} is not true or false.")
    try:
        machine = physical(name, given, bool(unusual))
    except QuantityError as error:
        section = places.get(str(error).split(" ", 1)[0].rstrip(":"), "model")
        return None, [*wrong, f"[{section}] {error}."]
    return machine.given_by(over.name) if over else machine, wrong


def _parameter(section: object) -> str | None:
    name = section.get("parameter") if isinstance(section, dict) else None
    return name if isinstance(name, str) else None


def _middle(quantity: Quantity, continued: dict[str, Any]) -> object:
    """Return the middle of the interval of `[continue]` as a quantity in the unit of its lower end; an invalid interval is returned unchanged.

    Raises
    ------
    QuantityError
        If an end is no quantity of this kind.
    """
    within = continued.get("within")
    if not isinstance(within, list) or len(within) != 2:
        return within
    (low, unit), (high, other) = (units.read(quantity, end) for end in within)
    return units.text(
        0.5 * (low + high * units.si(quantity, 1.0, other) / units.si(quantity, 1.0, unit)), unit
    )


def in_numbers(
    data: dict[str, Any],
    number: Callable[[str | None, object, str, int], object],
    units_of: Mapping[str, str] | None,
    wrong: list[str],
) -> dict[str, Any]:
    """Return a study with the quantities in its intervals, lists of values and bounds as numbers.

    Parameters
    ----------
    data : dict
        The sections of the study.
    number : callable
        ``number(parameter, value, place, i)`` returns entry i of the list at a place (``"[continue] within"``) as a number, or unchanged for
        later checks; it raises a ValueError with the message.
    units_of : mapping or None
        Units of measures, for the bounds; None if they are not known.
    wrong : list of str
        Messages of errors are added to it. Lists with errors are replaced by ascending numbers, so that each error is told once.
    """

    def bound(measure: str | None, given: object, place: str, i: int) -> object:
        if units_of is None or not isinstance(given, str):
            return float(i) if units_of is None else given
        with refused(place):
            return units.counted(str(measure), given, units_of.get(str(measure), ""))

    def each(read: Any, name: str | None, values: object, place: str) -> object:
        if not isinstance(values, list):
            return values
        found, refusals = [], []
        for i, given in enumerate(values):
            try:
                found.append(read(name, given, place, i))
            except ValueError as error:
                refusals.append(str(error))
        wrong.extend(refusals)
        return [*map(float, range(len(values)))] if refusals else found

    default = _parameter(data.get("continue"))
    found = dict(data)
    for section in ("continue", "sweep", "atlas", "chart"):
        if isinstance(values := data.get(section), dict):
            name = _parameter(values) or default
            lists = {key: values[key] for key in ("within", "values") if key in values}
            found[section] = values | {
                key: each(number, name, given, f"[{section}] {key}") for key, given in lists.items()
            }
            if isinstance(bounds := values.get("bounds"), dict):
                found[section]["bounds"] = {
                    measure: each(bound, measure, pair, f"[{section}] bounds")
                    for measure, pair in bounds.items()
                }
    return found


def number_of(machine: Physical, name: str, value: object, place: str, spread: bool = False) -> object:
    """Convert a value of the quantity `name` to a number in the machine's unit.

    Parameters
    ----------
    machine : Physical
    name : str
    value : object
        A text with a unit, or a number; other types are returned unchanged, for later checks.
    place : str
        Beginning of the error message.
    spread : bool
        Whether the value is a standard deviation, which has no lower limit.

    Raises
    ------
    QuantityError
        If the value is invalid.
    """
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        return value
    quantity = machine.tables.quantities[name]
    own = machine.units.get(name, "")
    try:
        number, unit = units.read(quantity, value)
        if not spread:
            units.check_limits(quantity, number, unit, machine.base.limits)
            if not machine.unusual:
                units.check_usual(quantity, units.si(quantity, number, unit), f"{name} = {value!r}")
    except QuantityError as error:
        raise QuantityError(f"{place} = {str(error).partition(' = ')[2]}.") from None
    if unit != own:
        number = number * units.si(quantity, 1.0, unit) / units.si(quantity, 1.0, own)
    if not spread:
        try:
            machine.given_by(name).check_at(name, number)
        except QuantityError as error:
            raise QuantityError(f"{place} = {value!r}: {error}.") from None
    return number
