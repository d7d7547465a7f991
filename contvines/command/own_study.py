"""Studies of declared machines (pages): one that comes with the package (`coupled_two`), or one of a Python file; and studies of flows.

A study names a Python file by `[model] name = "file.py:name"`; `name` is a machine or a contvines.FlowProblem. The file is run when the
study is read. It must lie in the study's folder or below, so that a study runs only code that came with it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from pydantic import Field

from orbits.machines.names import PAGES, STRUCTURE

from ..shared.files import module_of, names_of
from .schema import FlowSections, PageSections, study_model, text, values_of
from .study_data import Sort, Study, StudyError, refuse, refused, validated, wrong_intervals

if TYPE_CHECKING:
    from orbits.machines.page.machine import Machine

    from ..flows.problem import FlowProblem

F = TypeVar("F", PageSections, FlowSections)


def read_own(data: dict[str, Any], path: Path) -> Study:
    """Check a study whose `[model]` names a Python file or a page of the package.

    Raises
    ------
    StudyError
        If a value is invalid.
    OSError
        If the file cannot be read.
    """
    from orbits.machines.page.machine import Machine

    from ..flows.files import load_flow

    name_given = str(data["model"]["name"])
    if name_given == STRUCTURE:
        machine, data = _structure(data, path)
        return _page(data, path, machine)
    if name_given in PAGES:
        from orbits.machines.names import page_machine

        machine = page_machine(name_given)
        assert isinstance(machine, Machine)
        return _page(data, path, machine)
    page, _, name = name_given.partition(":")
    if not name:
        raise StudyError(
            f'[model] name = {name_given!r} names a file but no machine in it; for example "{page}:machine".'
        )
    file = own_code(path, page, f"[model] name = {name_given!r}")
    flow = load_flow(file, name) if file.is_file() else None
    if flow is not None:
        return _flow(data, path, flow)
    from orbits.machines.page.loading import load_page

    return _page(data, path, load_page(file, name))


def _section(data: dict[str, Any], name: str) -> dict[str, Any]:
    section = data.get(name)
    return section if isinstance(section, dict) else {}


def _structure(data: dict[str, Any], path: Path) -> tuple[Machine, dict[str, Any]]:
    """Return the structure that a study describes, and the study without its matrices and elements."""
    from orbits.machines.parameters import ParameterError
    from orbits.machines.structure import GIVEN, MATRICES, MEANT, structure

    model, start, continued = (_section(data, name) for name in ("model", "start", "continue"))
    for name in MATRICES:
        if name not in model:
            raise StudyError(
                f'[model] {name} is missing; for example {name} = [[2, -1], [-1, 2]], "{name}.csv" or "model.mat:{name[0].upper()}".'
            )
    spec = {name: model[name] for name in (*MATRICES, *GIVEN) if name in model}
    within = continued.get("within") if continued.get("parameter") == "frequency" else None
    highest = [x for x in (within if isinstance(within, list) else []) if isinstance(x, float | int)]
    given = start.get("frequency", model.get("frequency", sum(highest) / len(highest) if highest else None))
    if isinstance(given, float | int) and not isinstance(given, bool):
        spec |= {"frequency": float(given), "highest": spec.get("highest", MEANT * max([given, *highest]))}
    try:
        machine = structure(**spec, folder=path.parent)
    except (ParameterError, TypeError) as error:
        raise StudyError(f"[model] {str(error).rstrip('.')}.") from None
    rest = {name: value for name, value in model.items() if name not in (*MATRICES, *GIVEN)}
    return machine, {**data, "model": rest}


def _values(
    base: type[F], parameters: Mapping[str, float], data: dict[str, Any]
) -> tuple[F, dict[str, float]]:
    """Check the sections of a study; return them and the values of the parameters.

    Raises
    ------
    StudyError
    """
    if "name" in parameters:
        given = _section(data, "model")["name"]
        raise StudyError(
            f"[model] name = {given!r} is the file; its parameter 'name' needs another name, such as 'name_', that a study can give."
        )
    kinds: dict[str, Any] = {
        name: Annotated[float, text(f"a number, for example {value:g}")] for name, value in parameters.items()
    }
    settings: dict[str, Any] = {name: (kind | None, None) for name, kind in kinds.items()}
    settings["name"] = (Annotated[str, Field(pattern="|".join([r"\.py", STRUCTURE, *PAGES]))], ...)
    file = validated(study_model(base, settings, kinds), data)
    return file, values_of(file, kinds)


def _flow(data: dict[str, Any], path: Path, flow: FlowProblem) -> Study:
    defaults = dict(flow.values.values)
    file, values = _values(FlowSections, defaults, data)
    parameters = {**defaults, **values}
    wrong = wrong_intervals(file, parameters[file.continue_.parameter], lambda name, value: "")
    state, box, size = file.start.state, file.start.box, len(flow.x0)
    if state is not None and len(state) != size:
        wrong.append(f"[start] state has {len(state)} numbers; the flow has {size} states.")
    if box is not None and len(box) != size:
        pairs = f"{len(box)} pair{'s' if len(box) > 1 else ''}"
        wrong.append(f"[start] box has {pairs}; the flow has {size} states.")
    refuse(wrong)
    # the box is also used by charts and by the brief search after a diagram
    flow.box = None if box is None else [(low, high) for low, high in box]
    return Study.of(path, Sort.FLOW, str(data["model"]["name"]), parameters, file, flow=flow)


def _counted(data: dict[str, Any], machine: Machine) -> dict[str, Any]:
    """Convert the quantities (texts such as `"15 mm"`) in a study of a machine with units to numbers in these units.

    Raises
    ------
    StudyError
        If a quantity has a unit of another dimension.
    """
    from orbits.machines.physical.units import QuantityError, counted

    from .physical_study import in_numbers

    units = {name: unit for name, unit in machine.units.items() if name in machine.parameters}
    given = data.get("units")
    if given is not None and given != "si":
        raise StudyError(f'units = {given!r} is unknown; use "si", or leave it out.')
    if given is not None and not machine.units:
        raise StudyError(
            f"units = {given!r}: the machine {machine.name!r} gives no units; leave the line out, or declare it with Machine(..., units=)."
        )
    if not units:
        return data

    def number(name: str | None, given: object, place: str, i: int | None = None) -> object:
        if isinstance(given, list):
            return [number(name, one, place) for one in given]
        if isinstance(given, dict):  # of [survey] vary
            return {key: number(name, one, place) for key, one in given.items()}
        if not (isinstance(given, str) and name in units):
            return given
        try:
            return counted(name, given, units[name])
        except QuantityError as error:
            raise StudyError(f"{place}{'' if i is None else ': '}{error}.") from None

    def numbers(section: dict[str, Any], place: str) -> dict[str, Any]:
        return {name: number(name, given, place) for name, given in section.items()}

    wrong: list[str] = []
    found = in_numbers(data, number, machine.units, wrong)
    found.pop("units", None)
    refuse(wrong)
    for section in ("model", "start"):
        if isinstance(found.get(section), dict):
            found[section] = numbers(found[section], f"[{section}] ")
    survey = _section(data, "survey")
    if isinstance(survey.get("vary"), dict):
        found["survey"] = {**survey, "vary": numbers(survey["vary"], "[survey] vary.")}
    return found


def _page(data: dict[str, Any], path: Path, machine: Machine) -> Study:
    data = _counted(data, machine)
    file, values = _values(PageSections, machine.parameters, data)

    def refusal(parameter: str, value: float) -> str:
        try:
            machine.vector({**parameters, parameter: value})
        except ValueError as error:
            return f": {error}."
        return ""

    parameters = {**machine.parameters, **values}
    over, (low, high) = file.continue_.parameter, file.continue_.within
    if over not in values and not low <= parameters[over] <= high:
        parameters[over] = 0.5 * (low + high)
    if refused := refusal(over, machine.parameters[over]):
        refuse([f"[model]{refused.removeprefix(':')}"])
    wrong = wrong_intervals(file, parameters[over], refusal)
    coordinates = (*machine.states, "phase")
    wrong += [
        f"[start] state has {key!r}; it may have {', '.join(coordinates)}."
        for key in file.start.state or {}
        if key not in coordinates
    ]
    if not wrong:
        try:
            machine.word(file.start.word or "", machine.vector(parameters))
        except ValueError as error:
            wrong.append(f"[start] {error}")
    refuse(wrong)
    return Study.of(
        path, Sort.PAGE, str(data["model"]["name"]), parameters, file, model=machine, loose=parameters
    )


# ---------------------------------------------------------------------- Python files
def own_code(study: Path, file: str, place: str) -> Path:
    """Return the path of a Python file that a study names, in the study's folder or below.

    Parameters
    ----------
    study : Path
        Of the study.
    file : str
        As the study names it.
    place : str
        The field of the study with its value, for the error message.

    Raises
    ------
    ValueError
        If the path leads out of the study's folder. (A symbolic link in the folder may lead out: the user has made it.)
    """
    name = Path(file)
    if name.is_absolute() or ".." in name.parts:
        raise ValueError(
            f"{place}: a study runs Python files of its own folder (or of folders in it) only; put {name.name}, or a link to it, "
            f'beside {study.name}; for example "{name.name}"'
        )
    return study.parent / name


def load_kinds(study: Path, given: str) -> tuple[Sequence[Any], str]:
    """Run a Python file beside the study, and return the built-in kinds of special points with those of the file, and the file's digest.

    Parameters
    ----------
    study : Path
    given : str
        File and name, from ``kinds = "file.py:name"`` in [continue]; the name is that of a :class:`contvines.Kind` or of a list of them.

    Raises
    ------
    ValueError
        If there is no such file, it raises an error, or has no kinds with that name.
    """
    from ..bifurcation.kind import Kind
    from ..bifurcation.kinds import KINDS, checked

    place = f"[continue] kinds = {given!r}"
    file, _, name = given.rpartition(":")
    path = own_code(study, file, place)
    if not (file and name and path.is_file()):
        raise ValueError(
            f'{place}: name a file beside the study and a kind in it, for example kinds = "saddles.py:neutral"'
        )
    with refused(place):
        module = module_of(path)
    found = getattr(module, name, None)
    own = [found] if isinstance(found, Kind) else list(found) if isinstance(found, list | tuple) else []
    if not own:
        kinds = ", ".join(names_of(module, Kind)) or "none"
        raise ValueError(f"{place}: {path} has no kind {name!r}; it has {kinds}")
    try:
        digest = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
        return checked([*(kind for kind in KINDS if kind not in own), *own]), digest
    except ValueError as error:
        raise ValueError(f"[continue] {error}") from None
