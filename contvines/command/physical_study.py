"""Studies in physical units: `units = "si"`, and quantities as text.

The quantities make a machine (`orbits.machines.physical`); intervals and values of whatever varies become numbers, counted in the unit
in which the machine's quantity was given. What is left is a study like any other.
"""

from typing import Any

import numpy as np

OWN = ("name", "units", "unusual")
SAID = ("word", "periods", "guess")


def is_physical(data: dict[str, Any]) -> bool:
    """Whether a study asks for physical units."""
    model = data.get("model")
    return "units" in data or (isinstance(model, dict) and "units" in model)


def converted(data: dict[str, Any]) -> tuple[Any, dict[str, Any], list[str]]:
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
    from orbits.machines.catalogue import model_class
    from orbits.machines.physical.machine import physical, tables
    from orbits.machines.physical.quantities import QuantityError

    model, start = data.get("model"), data.get("start")
    if not isinstance(model, dict) or not isinstance(start, dict):
        return None, {key: value for key, value in data.items() if key != "units"}, []
    plain = {key: value for key, value in data.items() if key not in ("units", "model")}
    units = data.get("units", model.get("units"))
    if units != "si":
        return None, _without_texts(plain), [f'units = {units!r} is unknown; "si" would do, or leave it out.']
    name = model.get("name")
    try:
        known = tables(model_class(str(name))).QUANTITIES
    except ValueError as error:
        return None, _without_texts(plain), [f"[model] {error}."]
    wrong = [
        _unknown(section, key, value, known, extra)
        for section, values, extra in (("model", model, OWN), ("start", start, SAID))
        for key, value in values.items()
        if key not in known and key not in extra
    ]
    plain["start"] = {key: value for key, value in start.items() if key in SAID}
    told = {key: (f"[start] {key}", value) for key, value in start.items() if key in known}
    groups = {known[key].choice for key in told}
    told |= {
        key: (f"[model] {key}", value)
        for key, value in model.items()
        if key in known
        and known[key].choice not in groups  # [start] replaces what [model] says of the same thing
    }
    machine = None
    try:
        machine = physical(str(name), {k: v for k, (_, v) in told.items()}, bool(model.get("unusual", False)))
    except QuantityError as error:
        return None, _without_texts(plain), [*wrong, f"{_placed(str(error), told)}."]
    return _numbers(machine, plain, known, wrong)


def _without_texts(plain: dict[str, Any]) -> dict[str, Any]:
    """The sections with numbers in place of quantities that no machine can read, so that these are not refused as well."""
    found = {}
    for section, values in plain.items():
        found[section] = dict(values) if isinstance(values, dict) else values
        for key in ("within", "values") if isinstance(values, dict) else ():
            if isinstance(values.get(key), list) and any(isinstance(value, str) for value in values[key]):
                found[section][key] = [float(i) for i in range(len(values[key]))]
        if isinstance(values, dict) and isinstance(values.get("bounds"), dict):
            found[section].pop("bounds")
    return found


def _numbers(
    machine: Any, plain: dict[str, Any], known: Any, wrong: list[str]
) -> tuple[Any, dict[str, Any], list[str]]:
    """The intervals and values in all sections as numbers; the machine tells them by the quantity that varies."""
    go = plain.get("continue")
    usual = go.get("parameter") if isinstance(go, dict) else None
    if isinstance(usual, str) and usual in known:
        machine = machine.told_by(usual)
    sections = {}
    for section, values in plain.items():
        if not isinstance(values, dict) or section in ("start", "survey"):
            sections[section] = values
            continue
        from orbits.machines.physical.quantities import near_quantity

        name = values.get("parameter", usual)
        changed = dict(values)
        if isinstance(name, str) and name not in known and "parameter" in values:
            wrong.append(
                f"[{section}] parameter = {name!r}: the model {machine.name!r} has no such quantity"
                f"{near_quantity(name, known)}; it has {', '.join(known)}."
            )
            changed["within"] = [0.0, 1.0]
        for key in ("within", "values"):
            if isinstance(values.get(key), list) and isinstance(name, str) and name in known:
                told = machine.told_by(name)
                places = [f"[{section}] {key}[{i}]" for i in range(len(values[key]))]
                pairs = [number_of(told, name, *pair) for pair in zip(values[key], places, strict=True)]
                refused = [refusal for _, refusal in pairs if refusal]
                wrong += refused
                # numbers that nothing is wrong with in place of refused ones, so that these are refused once
                usual_value = told.quantities.get(name) or 1.0
                sound = np.linspace(0.5 * usual_value, usual_value, len(pairs)).tolist()
                changed[key] = sound if refused else [number for number, _ in pairs]
        if isinstance(values.get("bounds"), dict):
            changed["bounds"], refused = _bounds(machine.units, values["bounds"], section)
            wrong += refused
        sections[section] = changed
    return machine, sections, wrong


def _bounds(own: dict[str, str], bounds: dict[str, Any], section: str) -> tuple[dict[str, Any], list[str]]:
    """Bounds of measures counted in the units in which these are shown, and refusals; plain numbers are counted in them already."""
    from orbits.machines.physical import units
    from orbits.machines.physical.quantities import QuantityError

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
    machine: Any, name: str, value: Any, place: str, spread: bool = False
) -> tuple[Any, str | None]:
    """A value of quantity `name` counted in the machine's unit of it, and a refusal.

    A `spread` of values, their deviation, may be as small as it likes. What is neither text nor a number is left to others to refuse.
    """
    from orbits.machines.physical import units
    from orbits.machines.physical.quantities import QuantityError

    if isinstance(value, bool) or not isinstance(value, str | int | float):
        return value, None
    quantity = machine.tables.QUANTITIES[name]
    own = machine.units.get(name, "")
    try:
        number, unit = units.read(quantity, value)
        if not machine.unusual and not spread:
            units.check_usual(quantity, units.si(quantity, number, unit), f"{name} = {value!r}")
    except QuantityError as error:
        return value, f"{place} = {str(error).partition(' = ')[2]}."
    if unit != own:
        number = number * units.si(quantity, 1.0, unit) / units.si(quantity, 1.0, own)
    if not spread:
        try:
            machine.told_by(name).check_at(name, number)
        except QuantityError as error:
            return value, f"{place} = {value!r}: {error}."
    return number, None


def _unknown(section: str, key: str, value: Any, known: Any, extra: tuple[str, ...]) -> str:
    from orbits.machines.physical.quantities import near_quantity

    return (
        f"[{section}] {key} = {value!r}: there is no such quantity{near_quantity(key, [*known, *extra])}; "
        f"known are {', '.join([*extra, *known])}."
    )


def _placed(sentence: str, told: dict[str, tuple[str, Any]]) -> str:
    """A refusal with the section of the quantity that it names first."""
    first = sentence.split(" ", 1)[0].rstrip(":")
    place = told[first][0] if first in told else f"[model] {first}"
    return place + sentence[len(first) :]
