"""A study in physical units: `units = "si"`, and quantities as text.

The quantities make a machine (`orbits.machines.physical`); intervals and values of whatever varies become numbers, counted in the unit
in which the machine's quantity was given. What is left is a study like any other.
"""

from pathlib import Path
from typing import Any

import numpy as np

from contvines.command.catalogue_study import built, wrong_guess
from contvines.command.schema import StudySections
from contvines.command.study_data import Sort, Study, wrong_intervals
from contvines.command.study_errors import refuse, validated
from orbits.machines.names import model_class
from orbits.machines.physical import units
from orbits.machines.physical.machine import Physical, physical, tables
from orbits.machines.physical.quantities import Quantity, QuantityError, near_quantity

OWN = ("name", "units", "unusual", "contact_time")
SAID = ("word", "periods", "guess")


def read_physical(data: dict[str, Any], path: Path) -> Study:
    """A study in physical units.

    Raises
    ------
    StudyError
    """
    machine, plain, wrong = converted(data)
    file = validated(StudySections, plain, wrong)
    if machine is None and not wrong:
        wrong = ["the section [model] is missing; it holds the machine's name and its quantities."]
    refuse(wrong)
    assert machine is not None
    go, own = file.continue_, machine.quantities
    unit = machine.units.get(go.parameter, "")
    wrong = wrong_intervals(file, own.get(go.parameter), lambda name, value: "", unit)
    refuse([*wrong, *wrong_guess(file.start.guess, machine)])
    return built(Study.of(path, Sort.PHYSICAL, machine.name, own, file, model=machine))


def converted(data: dict[str, Any]) -> tuple[Physical | None, dict[str, Any], list[str]]:
    """The machine of a study in physical units, the study with numbers in place of quantities, and what is wrong.

    Returns
    -------
    machine : Model or None
        None where it cannot be made.
    data : dict
        Without the sections' quantities.
    wrong : list of str
        Sentences.
    """
    model, start = data.get("model"), data.get("start", {})
    plain = {key: value for key, value in data.items() if key not in ("units", "model")}
    if not isinstance(model, dict) or not isinstance(start, dict):
        return None, plain, []
    plain["start"] = {key: value for key, value in start.items() if key in SAID}
    go = plain.get("continue")
    usual, within = _parameter(go), go.get("within") if isinstance(go, dict) else None
    machine, wrong = _machine(data.get("units", model.get("units")), model, start, usual, within)
    for section, values in plain.items():
        if isinstance(values, dict) and section not in ("start", "survey", "random"):
            plain[section], refused = _numbers(machine, section, values, usual)
            wrong += refused
    return machine, plain, wrong


def _machine(
    said: object, model: dict[str, Any], start: dict[str, Any], usual: str | None, within: object
) -> tuple[Physical | None, list[str]]:
    """The machine of `[model]` and `[start]`, counted in the unit of what varies; None where it cannot be made; and what is wrong."""
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
    over = known.get(usual or "")
    said_already = {known[key].choice for key in (*model, *start) if key in known}
    if over is not None and "word" not in start and over.choice not in said_already:
        start = {**start, over.name: _middle(over, within)}
    # [start] replaces what [model] says of the same thing
    groups = {known[key].choice for key in start if key in known}
    places = {key: "model" for key in model if key in known and known[key].choice not in groups}
    places |= {key: "start" for key in start if key in known}
    try:
        given = {key: (model if section == "model" else start)[key] for key, section in places.items()}
        given |= {key: model[key] for key in ("contact_time",) if key in model}
        machine = physical(name, given, bool(model.get("unusual", False)))
    except QuantityError as error:
        section = places.get(str(error).split(" ", 1)[0].rstrip(":"), "model")
        return None, [*wrong, f"[{section}] {error}."]
    return machine.given_by(over.name) if over else machine, wrong


def _parameter(section: object) -> str | None:
    name = section.get("parameter") if isinstance(section, dict) else None
    return name if isinstance(name, str) else None


def _middle(quantity: Quantity, within: object) -> object:
    """The middle of an interval as a quantity in the unit of its lower end; that end itself where it is no interval of quantities.

    Raises
    ------
    QuantityError
        If an end is no such quantity.
    """
    if not isinstance(within, list) or len(within) != 2:
        return within
    (low, unit), (high, other) = (units.read(quantity, end) for end in within)
    return units.text(
        0.5 * (low + high * units.si(quantity, 1.0, other) / units.si(quantity, 1.0, unit)), unit
    )


def _numbers(
    machine: Physical | None, section: str, values: dict[str, Any], usual: str | None
) -> tuple[dict[str, Any], list[str]]:
    """A section with numbers in place of quantities, and refusals; the machine tells them by the quantity that varies.

    Without a machine, or where they are refused, numbers that nothing is wrong with stand in their place, so that these are refused once.
    """
    changed, wrong = dict(values), []
    lists = {key: values[key] for key in ("within", "values") if isinstance(values.get(key), list)}
    if machine is None:
        if isinstance(values.get("bounds"), dict):
            del changed["bounds"]
        unread = {key: texts for key, texts in lists.items() if any(isinstance(text, str) for text in texts)}
        return changed | {key: [float(i) for i in range(len(texts))] for key, texts in unread.items()}, []
    name, known = _parameter(values) or usual, machine.tables.quantities
    if name is None:
        return changed, wrong
    if name in known:
        given = machine.given_by(name)
        sound = given.quantities.get(name) or 1.0
        for key, texts in lists.items():
            pairs = [number_of(given, name, text, f"[{section}] {key}[{i}]") for i, text in enumerate(texts)]
            refused = [refusal for _, refusal in pairs if refusal]
            wrong += refused
            changed[key] = (
                np.linspace(0.5 * sound, sound, len(pairs)).tolist() if refused else [n for n, _ in pairs]
            )
    elif "parameter" in values:
        wrong.append(
            f"[{section}] parameter = {name!r}: the model {machine.name!r} has no such quantity"
            f"{near_quantity(name, known)}; it has {', '.join(known)}."
        )
        changed["within"] = [0.0, 1.0]
    if isinstance(values.get("bounds"), dict):
        changed["bounds"], refused = _bounds(machine.units, values["bounds"], section)
        wrong += refused
    return changed, wrong


def _bounds(own: dict[str, str], bounds: dict[str, Any], section: str) -> tuple[dict[str, Any], list[str]]:
    """Bounds of measures counted in the units in which these are shown, and refusals; plain numbers are counted in them already."""
    found, wrong = {}, []
    for name, pair in bounds.items():
        found[name] = list(pair) if isinstance(pair, list) else pair
        for i, value in enumerate(pair if isinstance(pair, list) else []):
            if isinstance(value, str):
                found[name][i] = float(i)
                try:
                    found[name][i] = units.counted(name, value, own.get(name, ""))
                except QuantityError as error:
                    wrong.append(f"[{section}] bounds: {error}.")
    return found, wrong


def number_of(
    machine: Physical, name: str, value: object, place: str, spread: bool = False
) -> tuple[object, str | None]:
    """A value of quantity `name` counted in the machine's unit of it, and a refusal.

    A `spread` of values, their deviation, may be as small as it likes. What is neither text nor a number is left to others to refuse.
    """
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        return value, None
    quantity = machine.tables.quantities[name]
    own = machine.units.get(name, "")
    try:
        number, unit = units.read(quantity, value)
        if not spread:
            units.check_limits(quantity, number, unit, machine.base.limits)
        if not machine.unusual and not spread:
            units.check_usual(quantity, units.si(quantity, number, unit), f"{name} = {value!r}")
    except QuantityError as error:
        return value, f"{place} = {str(error).partition(' = ')[2]}."
    if unit != own:
        number = number * units.si(quantity, 1.0, unit) / units.si(quantity, 1.0, own)
    if not spread:
        try:
            machine.given_by(name).check_at(name, number)
        except QuantityError as error:
            return value, f"{place} = {value!r}: {error}."
    return number, None
