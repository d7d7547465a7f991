"""Measures that a user asks for, as axes and bounds, checked before any work; and the one that is drawn when none is named."""

from pathlib import Path

from contvines.command.compose import machine
from contvines.command.study_data import Sort, Study
from contvines.shared.near_names import did_you_mean
from orbits.flows.catalogue import flow_of
from orbits.machines.measures import way_out

WITH_Y = ("diagram", "atlas", "trace", "plot")  # commands with axes


def check_bounds(study: Study, command: str) -> None:
    """Refuse bounds on measures that the study's machine does not have, and intervals that are none.

    Raises
    ------
    ValueError
        With a sentence that names the measure and the known ones.
    """
    if not study.bounds:
        return
    if command == "atlas":
        raise ValueError(
            "[continue] bounds: an atlas follows all that it meets to its end; leave them out, or use contvines diagram."
        )
    known = measures_of(study)
    for name, (low, high) in study.bounds.items():
        if name not in known:
            raise ValueError(
                f"[continue] bounds: there is no measure {name!r}{did_you_mean(name, known)}; choose one of {', '.join(known)}."
            )
        if not low < high:
            raise ValueError(
                f"[continue] bounds: {name} = [{low:g}, {high:g}] is no interval; "
                f"expected low < high, -inf or inf where there is no bound."
            )


def check_axes(study: Study, axes: dict[str, str | None], plot: Path | None) -> None:
    """Refuse measures that the study's machine does not have, and axes without a picture.

    Parameters
    ----------
    study : Study
    axes : option -> name of a measure, or None where it is not given.
    plot : where the picture goes, or None.

    Raises
    ------
    ValueError
        With a sentence that names the option, the measure and those there are.
    """
    for option, name in axes.items():
        if name is None:
            continue
        known = list(dict.fromkeys([study.parameter, *measures_of(study)]))
        if name not in known:
            raise ValueError(
                f"{option} {name}: there is no such measure{way_out(name) or did_you_mean(name, known)}; choose one of {', '.join(known)}."
            )
        if plot is None:
            raise ValueError(
                f"{option} {name}: there is no picture to show it in; give --plot FILE.png, too, or leave it out."
            )


def measures_of(study: Study) -> list[str]:
    """Names of all measures of a study's motions."""
    if study.sort is Sort.FLOW:
        return ["norm", "period", *study.flow.of_states]
    model = machine(study)
    return list(flow_of(model).measure_names(model))


def help_note(words: list[str]) -> str:
    """What the help adds for the file that stands on the line: the default of -y, or nothing."""
    command = next((word for word in words if not word.startswith("-")), "")
    files = [Path(word) for word in words if word.endswith((".toml", ".vines")) and Path(word).is_file()]
    if command not in WITH_Y or not files:
        return ""
    try:
        name = _default(files[0])
    except (ValueError, OSError):
        return ""  # the command itself says what is wrong with the file
    return f"For {files[0]} the default of -y is {name}.\n" if name else ""


def _default(path: Path) -> str:
    """The measure that is drawn of a study or graph if none is named."""
    if path.suffix == ".vines":
        from contvines.graph.graph import Graph
        from contvines.graph.measures import default_measure
        from contvines.store import load

        graph = load(path)
        return default_measure(graph) if isinstance(graph, Graph) else ""
    from contvines.command.study import read_study

    study = read_study(path)
    if study.sort is Sort.FLOW:
        return next(iter(study.flow.of_states))
    return flow_of(study.model).default_measure(study.model)
