"""A study of a flow: `[model] name = "file.py:flow"`, a contvines.FlowProblem in a Python file beside the study.

The file is Python and is run when the study is read: the user has named it. It lies in the study's folder or below.
"""

from pathlib import Path
from typing import Annotated, Any

from pydantic import ConfigDict, Field, ValidationError

from contvines.command.schema import AtlasSection, ContinueSection, Section, SweepSection
from contvines.command.sentences import sentences_of, together
from contvines.shared.near_names import did_you_mean


class FlowSection(Section):
    """`[model]`: file and object; other keys override values of parameters."""

    model_config = ConfigDict(extra="allow", frozen=True, strict=True, allow_inf_nan=False)
    name: str


class FlowStart(Section):
    """`[start]`: where a motion begins whose cycle is followed; without it, the equilibrium near the flow's own start. ``box`` are the ranges
    of the states from which an atlas and basins begin. Further keys are parameters."""

    model_config = ConfigDict(extra="allow", frozen=True, strict=True, allow_inf_nan=False)
    state: Annotated[list[float], Field(min_length=1)] | None = None
    box: list[Annotated[list[float], Field(min_length=2, max_length=2)]] | None = None


class FlowStudyFile(Section):
    model: FlowSection
    start: FlowStart = FlowStart()
    continue_: Annotated[ContinueSection, Field(alias="continue")]
    atlas: AtlasSection = AtlasSection()


def flow_of(data: dict[str, Any], path: Path) -> Any:
    """The flow that a study names; None where its file has no flow of that name."""
    from contvines.flows.files import load_flow

    model = data.get("model")
    name = model.get("name") if isinstance(model, dict) else None
    file, _, what = str(name).rpartition(":")
    inside = not Path(file).is_absolute() and ".." not in Path(file).parts
    if not (what and inside and (path.parent / file).is_file()):
        return None  # told by whom looks for a machine
    return load_flow(path.parent / file, what)


def check(data: dict[str, Any], path: Path, flow: Any) -> dict[str, Any]:
    """The fields of a `Study` from a study that names a flow.

    Raises
    ------
    ValueError
        With one sentence per value that cannot be used.
    """
    try:
        file = FlowStudyFile.model_validate(data)
    except ValidationError as error:
        raise ValueError(together(sentences_of(error, data))) from None
    known = dict(flow.values.values)
    given: dict[str, float] = {}
    wrong: list[str] = []
    for section, extra in (("model", file.model.model_extra), ("start", file.start.model_extra)):
        for key, value in (extra or {}).items():
            if key not in known:
                wrong.append(
                    f"[{section}] {key} = {value!r}: the flow has no such parameter"
                    f"{did_you_mean(key, known)}; it has {', '.join(known)}."
                )
            elif isinstance(value, bool) or not isinstance(value, (int, float)):
                wrong.append(f"[{section}] {key} = {value!r} is not a number.")
            else:
                given[key] = float(value)
    go, values = file.continue_, {**known, **given}
    low, high = (float(end) for end in go.within)
    if go.parameter not in known:
        wrong.append(
            f"[continue] parameter = {go.parameter!r}: the flow has no such parameter"
            f"{did_you_mean(go.parameter, known)}; it has {', '.join(known)}."
        )
    elif not low < high:
        wrong.append(f"[continue] within = {go.within!r} is empty or reversed; low < high would do.")
    elif not low <= values[go.parameter] <= high:
        wrong.append(
            f"[start] {go.parameter} = {values[go.parameter]!r} lies outside [continue] within = [{low!r}, {high!r}]; "
            "start inside the interval, or widen it."
        )
    if file.start.state is not None and len(file.start.state) != len(flow.x0):
        wrong.append(
            f"[start] state has {len(file.start.state)} numbers; the flow has {len(flow.x0)} states."
        )
    box = file.start.box
    if box is not None and len(box) != len(flow.x0):
        wrong.append(
            f"[start] box has {len(box)} pair{'s' if len(box) > 1 else ''}; the flow has {len(flow.x0)} states."
        )
    elif box is not None and not all(low < high for low, high in box):
        wrong.append(f"[start] box = {box!r}: each pair is (low, high), low < high.")
    if wrong:
        raise ValueError(together(wrong))
    return {
        "path": path,
        "name": file.model.name,
        "parameters": values,
        "word": None,
        "periods": 1,
        "guess": None,
        "parameter": go.parameter,
        "within": (low, high),
        "depth": go.depth,
        "virtual": go.virtual,
        "settings": go.model_dump(
            include={"tolerance", "angle", "max_step", "max_points", "max_branches"}, exclude_none=True
        ),
        "sweep": SweepSection(),
        "atlas": file.atlas,
        "bounds": {name: (low, high) for name, (low, high) in go.bounds.items()},
        "kinds": go.kinds,
        "flow": flow,
        "start_state": file.start.state,
        "box": box,
    }


def seed_of(study: Any) -> Any:
    """What a study of a flow begins with: its equilibria, or the cycle on which a motion settles.

    Raises
    ------
    ValueError
        If the motion does not become periodic.
    """
    flow, values = study.flow, study.parameters
    if study.start_state is not None or flow.field.forced:
        return flow.attractor(study.start_state, **values)
    return flow.equilibria(study.parameter, values)


def measure_names(study: Any) -> list[str]:
    """Names of the measures of a flow: of its equilibria, its cycles, or both."""
    d = len(study.flow.x0)
    return ["norm", "period", *(f"{word} x{j}" for word in ("max", "min", "mean") for j in range(d))]
