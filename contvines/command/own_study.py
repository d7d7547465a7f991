"""A study of a machine that comes as a page with the package (`coupled_two`), or of what a Python file beside it declares: `[model] name = "file.py:name"`, a machine (a page) or a contvines.FlowProblem.

The file is run when the study is read: the user has named it. It lies in the study's folder or below, so that a study runs nothing that
has not come with it.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from pydantic import Field

from contvines.command.own_code import own_code
from contvines.command.schema import FlowSections, PageSections, given, model_section, study_model, text
from contvines.command.study_data import Sort, Study, wrong_intervals
from contvines.command.study_errors import StudyError, refuse, validated
from orbits.machines.names import PAGES, STRUCTURE

if TYPE_CHECKING:
    from contvines.flows.problem import FlowProblem
    from orbits.machines.page.machine import Machine

F = TypeVar("F", PageSections, FlowSections)


def read_own(data: dict[str, Any], path: Path) -> Study:
    """A study whose `[model]` names a Python file.

    Raises
    ------
    StudyError, OSError
    """
    from contvines.flows.files import load_flow

    said = str(data["model"]["name"])
    if said == STRUCTURE:
        machine, plain = _structure(data, path)
        return _page(plain, path, machine)
    if said in PAGES:
        from orbits.machines.names import page_machine
        from orbits.machines.page.machine import Machine

        machine = page_machine(said)
        assert isinstance(machine, Machine)
        return _page(data, path, machine)
    page, _, name = said.partition(":")
    if not name:
        raise StudyError(
            f'[model] name = {said!r} names a file but no machine in it; for example "{page}:machine".'
        )
    file = own_code(path, page, f"[model] name = {said!r}")
    flow = load_flow(file, name) if file.is_file() else None
    if flow is not None:
        return _flow(data, path, flow)
    from orbits.machines.page.loading import load_page

    return _page(data, path, load_page(file, name))


def _section(data: dict[str, Any], name: str) -> dict[str, Any]:
    section = data.get(name)
    return section if isinstance(section, dict) else {}


def _structure(data: dict[str, Any], path: Path) -> tuple["Machine", dict[str, Any]]:
    """The structure of a study, and the study without its matrices and elements."""
    from orbits.machines.parameters import ParameterError
    from orbits.machines.structure import GIVEN, MATRICES, MEANT, structure

    model, start, go = (_section(data, name) for name in ("model", "start", "continue"))
    for name in MATRICES:
        if name not in model:
            raise StudyError(
                f'[model] {name} is missing; for example {name} = [[2, -1], [-1, 2]], "{name}.csv" or "model.mat:{name[0].upper()}".'
            )
    spec = {name: model[name] for name in (*MATRICES, *GIVEN) if name in model}
    within = go.get("within")
    highest = [
        x
        for x in (within if isinstance(within, list) else [])
        if isinstance(x, float | int) and go.get("parameter") == "frequency"
    ]
    said = start.get("frequency", model.get("frequency", sum(highest) / len(highest) if highest else None))
    if isinstance(said, float | int) and not isinstance(said, bool):
        spec |= {"frequency": float(said), "highest": spec.get("highest", MEANT * max([said, *highest]))}
    try:
        machine = structure(**spec, folder=path.parent)
    except (ParameterError, TypeError) as error:
        raise StudyError(f"[model] {str(error).rstrip('.')}.") from None
    rest = {name: value for name, value in model.items() if name not in (*MATRICES, *GIVEN)}
    return machine, {**data, "model": rest}


def _values(base: type[F], known: Mapping[str, float], data: dict[str, Any]) -> tuple[F, dict[str, float]]:
    """The checked sections, and the values that they give to parameters.

    Raises
    ------
    StudyError
    """
    if "name" in known:
        said = _section(data, "model")["name"]
        raise StudyError(
            f"[model] name = {said!r} is the file; its parameter 'name' needs another name, such as 'name_', that a study can give."
        )
    kinds: dict[str, Any] = {
        name: Annotated[float, text(f"a number, for example {value:g}")] for name, value in known.items()
    }
    settings: dict[str, Any] = {
        "name": (Annotated[str, Field(pattern="|".join([r"\.py", STRUCTURE, *PAGES]))], ...)
    }
    settings = {**{name: (kind | None, None) for name, kind in kinds.items()}, **settings}
    file = validated(study_model(base, settings, kinds), data)
    return file, {**given(model_section(file), kinds), **given(file.start, kinds)}


def _flow(data: dict[str, Any], path: Path, flow: "FlowProblem") -> Study:
    known = dict(flow.values.values)
    file, values = _values(FlowSections, known, data)
    parameters = {**known, **{name: float(value) for name, value in values.items()}}
    wrong = wrong_intervals(file, parameters[file.continue_.parameter], lambda name, value: "")
    state, box, size = file.start.state, file.start.box, len(flow.x0)
    if state is not None and len(state) != size:
        wrong.append(f"[start] state has {len(state)} numbers; the flow has {size} states.")
    if box is not None and len(box) != size:
        pairs = f"{len(box)} pair{'s' if len(box) > 1 else ''}"
        wrong.append(f"[start] box has {pairs}; the flow has {size} states.")
    elif box is not None and not all(low < high for low, high in box):
        wrong.append(f"[start] box = {box!r}: each pair is (low, high), low < high.")
    refuse(wrong)
    flow.box = (
        None if box is None else [(low, high) for low, high in box]
    )  # of charts, and of the look after a diagram, as well
    return Study.of(path, Sort.FLOW, str(data["model"]["name"]), parameters, file, flow=flow)


def _counted(data: dict[str, Any], machine: "Machine") -> dict[str, Any]:
    """A study of a machine with units in which quantities, as `"15 mm"`, are numbers in these units.

    Raises
    ------
    StudyError
        If a quantity is of another kind.
    """
    from orbits.machines.physical.units import QuantityError, counted

    units = {name: unit for name, unit in machine.units.items() if name in machine.parameters}
    said = data.get("units")
    if said is not None and said != "si":
        raise StudyError(f'units = {said!r} is unknown; use "si", or leave it out.')
    if said is not None and not machine.units:
        raise StudyError(
            f"units = {said!r}: the machine {machine.name!r} gives no units; leave the line out, or declare it with Machine(..., units=)."
        )
    if not units:
        return data

    def number(name: object, said: object, where: str) -> object:
        if isinstance(said, list):
            return [number(name, one, where) for one in said]
        if isinstance(said, dict):  # of [survey] vary
            return {key: number(name, one, where) for key, one in said.items()}
        if not isinstance(said, str) or name not in units:
            return said
        try:
            return counted(str(name), said, units[str(name)])
        except QuantityError as error:
            raise StudyError(f"{where}{error}.") from None

    found = dict(data)
    if found.get("units") == "si":
        del found["units"]
    for section in ("model", "start"):
        if section in found:
            own = _section(data, section)
            found[section] = {name: number(name, said, f"[{section}] ") for name, said in own.items()}
    for section in ("continue", "chart"):
        own = _section(data, section)
        if "within" in own:
            within = number(own.get("parameter"), own["within"], f"[{section}] within: ")
            found[section] = {**own, "within": within}
    survey = _section(data, "survey")
    if isinstance(survey.get("vary"), dict):
        vary = {name: number(name, said, "[survey] vary.") for name, said in survey["vary"].items()}
        found["survey"] = {**survey, "vary": vary}
    return found


def _page(data: dict[str, Any], path: Path, machine: "Machine") -> Study:
    data = _counted(data, machine)
    file, values = _values(PageSections, machine.parameters, data)

    def refusal(parameter: str, value: float) -> str:
        try:
            machine.vector({**parameters, parameter: value})
        except ValueError as error:
            return f": {error}."
        return ""

    parameters = {**machine.parameters, **{key: float(value) for key, value in values.items()}}
    over, (low, high) = file.continue_.parameter, file.continue_.within
    if over not in values and not low <= parameters[over] <= high:
        parameters[over] = 0.5 * (low + high)
    if alone := refusal(over, machine.parameters[over]):
        refuse([f"[model]{alone.removeprefix(':')}"])
    wrong = wrong_intervals(file, parameters[over], refusal)
    known = (*machine.states, "phase")
    for key in file.start.state or {}:
        if key not in known:
            wrong.append(f"[start] state has {key!r}; it may have {', '.join(known)}.")
    if not wrong:
        try:
            machine.word(file.start.word or "", machine.vector(parameters))
        except ValueError as error:
            wrong.append(f"[start] {error}")
    refuse(wrong)
    return Study.of(
        path, Sort.PAGE, str(data["model"]["name"]), parameters, file, model=machine, loose=parameters
    )
