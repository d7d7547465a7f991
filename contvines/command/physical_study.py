"""Studies in physical units: `units = "si"`, and quantities as texts.

The quantities define a machine (`orbits.machines.physical`). Intervals and values of a varied quantity are converted to numbers in the
unit in which the machine's quantity is given; the rest is treated as in other studies.
"""

from pathlib import Path
from typing import Any

import numpy as np

from orbits.machines.names import model_class
from orbits.machines.physical import units
from orbits.machines.physical.machine import Physical, physical, tables
from orbits.machines.physical.quantities import Quantity, QuantityError, near_quantity

from .catalogue_study import built, wrong_guess
from .schema import StudySections
from .study_data import Sort, Study, refuse, validated, wrong_intervals

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
    if isinstance(model, dict) and isinstance(start, dict):
        plain["start"] = {key: value for key, value in start.items() if key in SAID}
        machine, wrong = _machine(data.get("units", model.get("units")), model, start, plain.get("continue"))
        over = _parameter(plain.get("continue"))
        for section, values in plain.items():
            if isinstance(values, dict) and section not in ("start", "survey", "random"):
                plain[section] = _numbers(machine, section, values, over, wrong)
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
    said: object, model: dict[str, Any], start: dict[str, Any], go: object
) -> tuple[Physical | None, list[str]]:
    """Return the machine of `[model]` and `[start]` (None if it cannot be made) and all errors.

    The quantity that `[continue]` varies is in the unit of its interval.
    """
    if said != "si":
        return None, [f'units = {said!r} is unknown; use "si", or leave it out.']
    name = str(model.get("name"))
    try:
        known = tables(model_class(name)).quantities
    except ValueError as error:
        return None, [f"[model] {error}."]
    wrong = [
        f"[{section}] {key} = {value!r}: there is no such quantity{near_quantity(key, [*known, *extra])}; "
        f"known are {', '.join([*extra, *known])}."
        for section, values, extra in (("model", model, OWN), ("start", start, SAID))
        for key, value in values.items()
        if key not in known and key not in extra
    ]
    over = known.get(_parameter(go) or "")
    said_already = {known[key].choice for key in (*model, *start) if key in known}
    if over is not None and "word" not in start and over.choice not in said_already:
        start = {**start, over.name: _middle(over, go)}
    # quantities in [start] replace those of the same choice in [model]
    groups = {known[key].choice for key in start if key in known}
    places = {key: "model" for key in model if key in known and known[key].choice not in groups}
    places |= {key: "start" for key in start if key in known}
    given = {key: (model if section == "model" else start)[key] for key, section in places.items()}
    given |= {key: model[key] for key in ("contact_time",) if key in model}
    try:
        machine = physical(name, given, bool(model.get("unusual", False)))
    except QuantityError as error:
        section = places.get(str(error).split(" ", 1)[0].rstrip(":"), "model")
        return None, [*wrong, f"[{section}] {error}."]
    return machine.given_by(over.name) if over else machine, wrong


def _parameter(section: object) -> str | None:
    name = section.get("parameter") if isinstance(section, dict) else None
    return name if isinstance(name, str) else None


def _middle(quantity: Quantity, go: object) -> object:
    """Return the middle of the interval of `[continue]` as a quantity in the unit of its lower end; an invalid interval is returned unchanged.

    Raises
    ------
    QuantityError
        If an end is no quantity of this kind.
    """
    within = go.get("within") if isinstance(go, dict) else None
    if not isinstance(within, list) or len(within) != 2:
        return within
    (low, unit), (high, other) = (units.read(quantity, end) for end in within)
    return units.text(
        0.5 * (low + high * units.si(quantity, 1.0, other) / units.si(quantity, 1.0, unit)), unit
    )


def _numbers(
    machine: Physical | None, section: str, values: dict[str, Any], usual: str | None, wrong: list[str]
) -> dict[str, Any]:
    """Convert the quantities in a section to numbers in the machine's unit of the varied quantity; add error messages to `wrong`.

    Without a machine, or for invalid quantities, valid dummy numbers are inserted, so that each error is reported once.
    """
    changed, bounds = dict(values), values.get("bounds")
    lists = {key: values[key] for key in ("within", "values") if isinstance(values.get(key), list)}
    if machine is None:
        if isinstance(bounds, dict):
            del changed["bounds"]
        unread = {key: texts for key, texts in lists.items() if any(isinstance(text, str) for text in texts)}
        return changed | {key: [float(i) for i in range(len(texts))] for key, texts in unread.items()}
    name, known = _parameter(values) or usual, machine.tables.quantities
    if name is None:
        return changed
    if name in known:
        given = machine.given_by(name)
        sound = given.quantities.get(name) or 1.0
        for key, texts in lists.items():
            numbers, refused = [], []
            for i, said in enumerate(texts):
                try:
                    numbers.append(number_of(given, name, said, f"[{section}] {key}[{i}]"))
                except QuantityError as error:
                    refused.append(str(error))
            wrong += refused
            changed[key] = np.linspace(0.5 * sound, sound, len(texts)).tolist() if refused else numbers
    elif "parameter" in values:
        wrong.append(
            f"[{section}] parameter = {name!r}: the model {machine.name!r} has no such quantity"
            f"{near_quantity(name, known)}; it has {', '.join(known)}."
        )
        changed["within"] = [0.0, 1.0]
    if isinstance(bounds, dict):  # plain numbers are in the displayed units of the measures
        changed["bounds"] = {}
        for measure, pair in bounds.items():
            changed["bounds"][measure] = list(pair) if isinstance(pair, list) else pair
            for i, value in enumerate(pair if isinstance(pair, list) else []):
                if isinstance(value, str):
                    number = float(i)
                    try:
                        number = units.counted(measure, value, machine.units.get(measure, ""))
                    except QuantityError as error:
                        wrong.append(f"[{section}] bounds: {error}.")
                    changed["bounds"][measure][i] = number
    return changed


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
