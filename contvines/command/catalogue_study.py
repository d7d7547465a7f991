"""Studies of built-in machines in their own (dimensionless) numbers."""

from pathlib import Path
from typing import Any

from orbits.flows import machine_of
from orbits.machines.base import Model
from orbits.machines.names import NAMES, PAGES, STRUCTURE, model_class
from orbits.machines.parameters import CONTACT_TIME
from orbits.words import Word

from ..shared.near_names import did_you_mean
from .schema import (
    UnknownModel,
    catalogue_model,
    expected_value,
    values_of,
)
from .study_data import (
    Sort,
    Study,
    StudyError,
    refuse,
    validated,
    without_word,
    wrong_intervals,
)


def read_catalogue(data: dict[str, Any], path: Path) -> Study:
    """Check a study whose `[model]` names a machine of the catalogue.

    Raises
    ------
    StudyError
        If a value is invalid.
    """
    model = data.get("model")
    name = model.get("name") if isinstance(model, dict) else None
    if name not in NAMES:
        refuse(_without_machine(data, model, name))
    name = str(name)
    file = validated(catalogue_model(name), data)
    machine = model_class(name)
    entries = {entry.name: entry for entry in machine.settable}
    parameters = values_of(file, entries)

    def refusal(parameter: str, value: float) -> str:
        if value in entries[parameter].limits.in_studies:
            return ""
        expected = expected_value(entries[parameter])
        return f" leaves the range of {parameter} at {value!r}; expected {expected} at both ends."

    over, driver = file.continue_.parameter, machine.driven_by
    low, high = file.continue_.within
    if file.start.word is None:
        parameters.setdefault(over, 0.5 * (low + high))
    wrong = wrong_intervals(file, parameters.get(over), refusal)
    if over not in parameters and not wrong:
        wrong.append(
            f"[start] {over} is missing: it is the continuation parameter's first value; expected a number from {low!r} to {high!r}."
        )
    elif driver not in parameters and driver != over:
        wrong.append(f"[start] {driver} is missing; expected {expected_value(entries[driver])}.")
    refuse([*wrong, *wrong_guess(file.start.guess, machine)])
    own = machine.field_names()
    loose = {key: value for key, value in parameters.items() if key not in own}
    given = {key: value for key, value in parameters.items() if key in own}
    try:
        catalogued = machine_of({"name": name, **given, **values_of(file, [CONTACT_TIME.name])})
    except ValueError as error:
        raise StudyError(f"[model] {error}") from error
    return built(Study.of(path, Sort.CATALOGUE, name, parameters, file, model=catalogued, loose=loose))


def _without_machine(data: dict[str, Any], model: object, name: object) -> list[str]:
    """Return all errors of a study whose model is unknown that can be found without it."""
    machines = (*NAMES, *PAGES, STRUCTURE)
    names = f'{", ".join(map(repr, machines))}, or a machine of your own, "FILE.py:NAME"'
    if name is not None:
        hint = did_you_mean(name, machines) if isinstance(name, str) else ""
        wrong = f"[model] name = {repr(name)[:60]}: there is no such machine{hint}; expected {names}."
    elif isinstance(model, dict):
        wrong = f"[model] name is missing; expected {names}."
    elif model is None:
        wrong = 'the section [model] is missing; it holds name = "absorber" and its parameters.'
    else:
        wrong = f"model = {repr(model)[:60]} is not a section; write [model] on a line of its own, its keys below."
    validated(UnknownModel, data, [wrong])
    return [wrong]


def wrong_guess(guess: list[list[float]] | None, machine: Model | type[Model]) -> list[str]:
    """Return errors about the nodes of a guess with a wrong count of numbers."""
    names = machine.node_names
    return [
        f"[start] guess[{i}] = {node!r} has {len(node)} numbers; each event needs [{', '.join(names)}]."
        for i, node in enumerate(guess or ())
        if len(node) != len(names)
    ]


def built(study: Study) -> Study:
    """Return the study after checking that its machine can be made and its word is possible.

    Raises
    ------
    StudyError
        If not.
    """
    try:
        vector = study.model.vector(study.loose)
    except ValueError as error:
        raise StudyError(f"[model] {error}") from error
    try:
        Word.parse(study.word or "", frictionless=study.model.frictionless(vector))
    except ValueError as error:
        raise StudyError(f"[start] {without_word(study, error)}") from error
    return study
