"""The axes and bounds that a user asks for, checked before any work."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from contvines.command.study import Study


def check_bounds(study: "Study", command: str) -> None:
    """Refuse bounds on measures that the study's machine does not have, and intervals that are none.

    Raises
    ------
    ValueError
        With a sentence that names the measure and what would do.
    """
    if not study.bounds:
        return
    if command == "atlas":
        raise ValueError(
            "[continue] bounds: an atlas follows all that it meets to its end; leave them out, or use contvines diagram."
        )
    from contvines.shared.near_names import did_you_mean

    known = _names(study)
    for name, (low, high) in study.bounds.items():
        if name not in known:
            raise ValueError(
                f"[continue] bounds: there is no measure {name!r}{did_you_mean(name, known)}; "
                f"choose one of {', '.join(known)}."
            )
        if not low < high:
            raise ValueError(
                f"[continue] bounds: {name} = [{low:g}, {high:g}] is no interval; "
                f"low < high would do, -inf or inf where there is no bound."
            )


def check_axes(study: "Study", axes: dict[str, str | None], plot: Path | None) -> None:
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
    given = {option: name for option, name in axes.items() if name is not None}
    if not given:
        return
    from contvines.shared.near_names import did_you_mean

    known = list(dict.fromkeys([study.parameter, *_names(study)]))
    for option, name in given.items():
        if name not in known:
            raise ValueError(
                f"{option} {name}: there is no such measure{did_you_mean(name, known)}; "
                f"choose one of {', '.join(known)}."
            )
    if plot is None:
        option, name = next(iter(given.items()))
        raise ValueError(
            f"{option} {name}: there is no picture to show it in; give --plot FILE.png, too, or leave it out."
        )


def _names(study: "Study") -> list[str]:
    if study.flow is not None:
        from contvines.command.flow_study import measure_names

        return measure_names(study)
    from contvines.command.compose import machine
    from orbits.flows.native.measures import names

    return list(names(machine(study)))
