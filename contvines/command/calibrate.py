"""`contvines calibrate STUDY.toml`: estimate restitution, friction and other parameters from measured impact times or a measured sweep."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from orbits.machines.physical.machine import Physical

from ..graph.table import with_unit
from ..shared.numbers import figures
from ..text_table import Table, fitted, terminal_width
from .compose import check_shaken, machine
from .frame import draw, tell
from .measured import Scales, measured
from .options import (
    JsonOption,
    PlotOption,
    SizeOption,
    amount,
    argument,
    option,
    refuse_alone,
)
from .physical_study import number_of
from .study import read_study
from .study_data import Sort, Study

if TYPE_CHECKING:
    from orbits.design.calibration import Calibration
    from orbits.machines.base import Model

# scatter of the data, relative to the time between impacts, from which on a warning is printed: clocks are more exact
INEXACT = 0.01
CLOSE = 0.95  # correlation of two estimates from which on it is printed


def calibrate(
    context: typer.Context,
    study: Annotated[Path, argument("STUDY.toml", "A study; the search begins at its values.")],
    impacts: Annotated[
        Path | None,
        option("--impacts FILE.csv", "Times of successive impacts, in one column."),
    ] = None,
    sweep: Annotated[
        Path | None,
        option("--sweep FILE.csv", "Steady responses: one column for the parameter, one for the response."),
    ] = None,
    unknown: Annotated[
        list[str] | None,
        option("--unknown NAME", "Parameter to estimate (repeatable); by default restitution."),
    ] = None,
    release: Annotated[
        str | None,
        option(
            "--release LENGTH",
            'The impacts are those of a free decay, released at this displacement: "5 mm".',
        ),
    ] = None,
    measure: Annotated[
        str | None,
        option("--measure NAME", "Measure that the sweep holds; by default max_abs_q1."),
    ] = None,
    limits: Annotated[
        list[str] | None,
        option("--limits NAME=LOW,HIGH", "Bounds of an estimate: restitution=0.3,0.9 (repeatable)."),
    ] = None,
    confidence: Annotated[float, option("--confidence", "Confidence level of the intervals.")] = 0.95,
    plot: PlotOption = None,
    size: SizeOption = None,
    json_: JsonOption = False,
) -> None:
    """Estimate restitution, friction and the like from a measurement, with confidence intervals.

    Impact times are counted from the first impact of a run that begins at rest with the excitation's phase 0
    (or, with --release, of a free decay).
    A sweep holds steady responses in the order in which they were measured. Column heads may name units: time [ms].
    """
    if (impacts is None) == (sweep is None):
        both = "both are" if impacts is not None else "neither is"
        raise ValueError(
            f"--impacts and --sweep: {both} given; give one of them: --impacts times.csv or --sweep responses.csv."
        )
    refuse_alone(context, release="--impacts", measure="--sweep")
    if not 0.0 < confidence < 1.0:
        raise ValueError(f"--confidence {confidence:g}: give a number between 0 and 1, for example 0.95.")
    read = read_study(study)
    if read.sort is Sort.PAGE and release is not None:
        raise ValueError(
            f"--release {release}: the study of a declared machine says where its motions begin: give [start] state and --impacts."
        )
    names = list(dict.fromkeys(unknown or ["restitution"]))
    if release is None:
        check_shaken(read, names)
    model, guesses = _guesses(read, names)
    bounds = _limits(limits or [], names, model)
    arguments = {"unknown": guesses, "limits": bounds, "fixed": read.loose, "confidence": confidence}
    path = sweep if impacts is None else impacts
    assert path is not None
    try:
        if impacts is not None:
            found, options = _from_impacts(read, model, path, release, arguments)
        else:
            found, options = _from_sweep(read, model, path, measure, arguments)
    except ValueError as error:
        text = str(error).rstrip(".")
        raise ValueError(f"{text}." if text.startswith(str(path)) else f"{path}: {text}.") from None
    units = {name: model.units[name] for name in names if model.units.get(name)}
    tell(fitted(calibration_text(found, units, guesses)), as_json(found, units) if json_ else None)
    if plot is not None:
        from ..plots.measured import plot_calibration

        draw(plot, lambda: plot_calibration(residuals=found.residuals, figsize=size, **options), json_)


def as_json(found: Calibration, units: dict[str, str]) -> dict[str, Any]:
    """Return a calibration as one JSON object."""
    return {
        "values": found.values,
        "intervals": {name: list(ends) for name, ends in found.intervals.items()},
        "confidence": found.confidence,
        "scatter": found.scatter,
        "correlation": found.correlation.tolist(),
        "residuals": found.residuals.tolist(),
        **({"units": units} if units else {}),
    }


def calibration_text(found: Calibration, units: dict[str, str], guesses: dict[str, float]) -> str:
    """Describe the estimates, correlated parameters, and the lines to write in the study."""
    rows = [
        (name, *map(figures, (value, *found.intervals[name], guesses[name])), units.get(name, ""))
        for name, value in found.values.items()
    ]
    heads = ("parameter", "estimate", "from", "to", "study says", "unit")
    lines = [*Table(heads, rows).lines(terminal_width()), ""]
    lines.append(
        f"from ... to: {100 * found.confidence:g} % confidence; {found.residuals.size} residuals scatter by {figures(found.scatter)}"
    )
    if found.scatter > INEXACT * found.between:
        lines.append(
            f"doubtful: the scatter is {100.0 * found.scatter / found.between:.2g} % of the mean time between impacts, and clocks are better; the search may "
            "have ended beside the true values, and the intervals do not know that. Ways out: narrower --limits, one --unknown less, fewer impacts"
        )
    names = list(found.values)
    for i, first in enumerate(names):
        for j in range(i):
            if abs(found.correlation[i, j]) > CLOSE:
                lines.append(
                    f"{names[j]} and {first} can hardly be distinguished by these data (correlation {found.correlation[i, j]:.3f})"
                )
    lines += ["", "for [survey] of the study:"]
    for name, value in found.values.items():
        unit = units.get(name)
        ends = ", ".join(f'"{x:.6g} {unit}"' if unit else f"{x:.6g}" for x in found.intervals[name])
        lines.append(f"vary.{name} = {{ uniform = [{ends}] }}    # {figures(value)}")
    return "\n".join(lines)


def _guesses(study: Study, names: list[str]) -> tuple[Any, dict[str, float]]:
    """Return the machine as varied by the unknown parameters, and the values of these in the study."""
    from orbits.machines.physical.quantities import near_quantity

    model = machine(study)
    names_known = list(model.tables.quantities if study.sort is Sort.PHYSICAL else model.amount_names)
    for name in names:
        if name not in names_known:
            raise ValueError(
                f"--unknown {name}: the model {study.name!r} has no such parameter{near_quantity(name, names_known)}; it has {', '.join(names_known)}."
            )
        if study.sort is Sort.PHYSICAL:
            model = model.given_by(name)
    values = model.quantities if study.sort is Sort.PHYSICAL else study.parameters
    return model, {name: float(values[name]) for name in names}


def _limits(texts: list[str], names: list[str], model: Model) -> dict[str, tuple[float, float]]:
    found = {}
    for text in texts:
        name, _, ends = text.partition("=")
        parts = ends.split(",")
        if name not in names:
            raise ValueError(
                f"--limits {text}: {name or 'nothing'} is not estimated; --unknown has {', '.join(names)}."
            )
        if len(parts) != 2:
            raise ValueError(f"--limits {text}: write it as {name}=LOW,HIGH, two values.")
        low, high = (_limit(text, name, part.strip(), model) for part in parts)
        if not low < high:
            raise ValueError(f"--limits {text}: expected low < high.")
        found[name] = (low, high)
    return found


def _limit(text: str, name: str, given: str, model: Model) -> float:
    """Return one end of the interval in which an estimate may lie, in the machine's unit."""
    try:
        value = amount("", given, name, model.units)
        if isinstance(model, Physical) and model.units.get(name):
            number_of(model, name, f"{value!r} {model.units[name]}", given)
        else:
            model.check_value(name, value)
    except ValueError as error:
        raise ValueError(f"--limits {text}: {str(error).strip(' :.')}.") from None
    return value


def _from_impacts(
    study: Study, model: Model, path: Path, release: str | None, arguments: dict[str, Any]
) -> tuple[Calibration, dict[str, Any]]:
    from orbits.design.calibration import from_impacts

    scales = Scales(model, model.vector(study.loose))
    second = scales.unit("time")
    (times,) = measured(path, {"time": second})
    start = study.state
    if release is not None:
        displacement = scales.number("--release", release, "length")
        if "damping" not in model.parameter_names:
            raise ValueError(
                f"--release {release}: the machine {model.name!r} has no oscillator to be let go."
            )
        start, model = {"q1": displacement, "q2": displacement}, model.changed(forcing=0.0)
    ylabel = with_unit("measured less computed", second)
    options = {"places": times, "heights": None, "xlabel": with_unit("time", second), "ylabel": ylabel}
    return from_impacts(model, times, start=start, **arguments), options


def _from_sweep(
    study: Study, model: Model, path: Path, measure: str | None, arguments: dict[str, Any]
) -> tuple[Calibration, dict[str, Any]]:
    from orbits.attractors.attractor import measure_names
    from orbits.design.calibration import from_sweep

    from ..plots.style import axis_label

    names = measure_names(model)
    over, name = study.parameter, measure or next(name for name in names if name.startswith("max_"))
    if name not in names:
        raise ValueError(f"--measure {name}: a simulation tells {', '.join(names)}.")
    if over in arguments["unknown"]:
        raise ValueError(
            f"--unknown {over}: this is what was swept ([continue] parameter); estimate something else."
        )
    unit, own = model.units.get(name, ""), model.units.get(over, "")
    values, heights = measured(path, {over: own, "response": unit})
    if own and isinstance(model, Physical):
        for row, value in enumerate(values, 1):
            number_of(model, over, f"{float(value)!r} {own}", f"{path}: {over} of measurement {row}")
    ylabel = axis_label(name, unit=unit or None, notation=model.notation)
    options = {"places": values, "heights": heights, "xlabel": with_unit(over, own), "ylabel": ylabel}
    return from_sweep(model, over, values, heights, measure=name, **arguments), options
