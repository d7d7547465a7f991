"""From a study to computations: its machine, population, first orbit, diagram or atlas, and the names of its measures."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import contvines
from orbits.flows import flow_of
from orbits.machines.measures import way_out

from ..shared.near_names import did_you_mean
from .study_data import Sort, Study, without_word

if TYPE_CHECKING:
    from ..graph import Graph

WITH_Y = ("diagram", "atlas", "trace", "plot")  # commands with an option -y


def machine(study: Study):
    """Return the machine of a study, with the parameter values that `[start]` overrides.

    Raises
    ------
    ValueError
        If it is a study of a flow.
    """
    if study.sort is Sort.FLOW:
        raise ValueError(
            f"{study.path}: this command needs a machine; of the flow {study.name!r} there are contvines diagram, trace, atlas, basins, "
            "survey and orbit, and of the file that they write plot, show, switch, locus, chart, circle, report and export"
        )
    return study.model


def check_shaken(study: Study, vary: Iterable[str] = ()) -> None:
    """Check that something shakes a study's machine, or that a parameter which varies does.

    Parameters
    ----------
    study : Study
    vary : iterable of str
        Parameters that vary besides the study's own one.

    Raises
    ------
    ValueError
        If it is not.
    """
    if study.sort not in (Sort.CATALOGUE, Sort.PHYSICAL):
        return
    unshaken = study.model.unshaken(study.model.vector(study.loose))
    if unshaken is not None and not any(map(study.model.shakes, (study.parameter, *vary))):
        zero, example = unshaken
        raise ValueError(
            f"{study.path}: {zero}: nothing shakes the machine, whatever {study.parameter} is; for example {example}."
        )


def population(study: Study):
    """Return the population of a study's machine or flow over the study's parameter."""
    own = study.parameters if study.sort is Sort.FLOW else study.loose
    fixed = {name: value for name, value in own.items() if name != study.parameter}
    if study.sort is Sort.FLOW:
        return study.flow.population_at(fixed, study.parameter)
    from ..coexistence.census import population_of

    return population_of(study.model, study.parameter, **fixed)


def first_orbit(study: Study):
    """Find the first orbit of a study.

    Raises
    ------
    ValueError
        If the word is impossible, or no orbit with it is found; the message names the study.
    """
    reduction = getattr(study.model, "reduction", None)
    if reduction is not None and reduction.error:
        print(f"contvines: {study.path}: [model] {reduction.sentence}.", file=sys.stderr)
    try:
        if study.sort is Sort.FLOW:
            if study.state is not None or study.flow.field.forced:
                return study.flow.attractor_at(study.parameters, study.state)
            return study.flow.equilibria(study.parameter, study.parameters)
        if study.sort is Sort.PAGE and study.start.word in (None, "") and not study.start.guess:
            return _page_start(study)
        if study.start.word is None:
            return _settled(study)
        from orbits.starts.find import StartWarning

        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("ignore")
            warnings.simplefilter("always", StartWarning)
            orbit = study.model.orbit(
                study.start.word, study.start.periods, guess=study.start.guess, **study.loose
            )
        for warning in caught:
            print(f"contvines: {study.path}: [start] {warning.message}.", file=sys.stderr)
        return orbit
    except ValueError as error:
        raise ValueError(f"{study.path}: [start] {without_word(study, error)}") from error


def _page_start(study: Study):
    """Return the first orbit of a declared machine: the motion on which its state settles, if necessary elsewhere in the interval.

    For a self-excited machine that comes to rest, or with the word "", it is the equilibrium near the state.
    """
    from contextlib import suppress

    from orbits.starts.find import StartError

    model, state = study.model, study.state
    if study.start.word == "" and model.forced:
        return model.orbit("", study.start.periods, **study.loose)
    if study.start.word is None:
        found = model.attractor(state, **study.loose)
        if not found.recurrent and (model.forced or found.kind == "aperiodic"):
            with suppress(StartError):
                return _settled(study)
        if found.kind != "rest" or found.trajectory.held or model.forced:
            return found.found
        state = dict(zip(model.states, map(float, found.state[1:]), strict=True))
    return model.smooth(state, **study.loose).equilibria(study.parameter)


def _settled(study: Study):
    """Return the motion that settles from rest, where the study begins or elsewhere in its interval, and report it on stderr."""
    from orbits.design import Family

    from ..graph.table import short_word

    orbit = Family(
        study.model, loose=study.loose, over=study.parameter, within=study.within, state=study.state
    )({})
    amount = orbit.model.amount(study.parameter, orbit.params)
    unit = study.model.units.get(study.parameter, "")
    print(
        f"contvines: {study.path}: [start] has no word; begun with the motion that settles from rest at {study.parameter} = "
        + f"{amount:g} {unit}".rstrip()
        + f": {short_word(orbit.word.text) if len(orbit.word) else 'the absorber does not move in its cavity'}.",
        file=sys.stderr,
    )
    return orbit


def run_diagram(study: Study, seed: object, **options: Any) -> Graph:
    """Compute the automatic diagram of a study from its first orbit; options as for `contvines.diagram`."""
    asked = {"bounds": study.bounds, "kinds": study.all_kinds, **study.options}
    return contvines.diagram(seed, over=study.parameter, within=study.within, **{**asked, **options})


def run_atlas(study: Study, seed: object, **options: Any) -> Graph:
    """Compute the atlas of a study; options as for `contvines.atlas`."""
    asked = {"kinds": study.all_kinds, **study.options, **study.atlas.model_dump()}
    return contvines.atlas(seed, within=study.within, **{**asked, **options})


def check_bounds(study: Study, command: str) -> None:
    """Check a study's bounds: known measures, and non-empty intervals.

    Raises
    ------
    ValueError
        If a bound is invalid; the message names the measure and the known ones.
    """
    if not study.bounds:
        return
    if command == "atlas":
        raise ValueError(
            "[continue] bounds: an atlas follows all that it meets to its end; leave them out, or use contvines diagram."
        )
    measures = measures_of(study)
    for name, (low, high) in study.bounds.items():
        if name not in measures:
            raise ValueError(
                f"[continue] bounds: there is no measure {name!r}{did_you_mean(name, measures)}; choose one of {', '.join(measures)}."
            )
        if not low < high:
            raise ValueError(
                f"[continue] bounds: {name} = [{low:g}, {high:g}] is no interval; "
                f"expected low < high, -inf or inf where there is no bound."
            )


def check_axes(study: Study, axes: dict[str, str | None], plot: Path | None) -> None:
    """Check the options for the axes of a picture: known measures, and a picture to draw.

    Parameters
    ----------
    study : Study
    axes : dict
        Name of a measure, or None, by option.
    plot : Path or None
        Of the picture.

    Raises
    ------
    ValueError
        If an axis is invalid; the message names the option, the measure and the known ones.
    """
    for option, name in axes.items():
        if name is None:
            continue
        measures = list(dict.fromkeys([study.parameter, *measures_of(study)]))
        if name not in measures:
            raise ValueError(
                f"{option} {name}: there is no such measure{way_out(name) or did_you_mean(name, measures)}; choose one of {', '.join(measures)}."
            )
        if plot is None:
            raise ValueError(
                f"{option} {name}: there is no picture to show it in; give --plot FILE.png, too, or leave it out."
            )


def measures_of(study: Study) -> list[str]:
    """Return the names of all measures of a study's motions."""
    if study.sort is Sort.FLOW:
        return ["norm", "period", *study.flow.of_states]
    model = machine(study)
    return list(flow_of(model).measure_names(model))


def help_note(words: list[str]) -> str:
    """Return the addition to a command's help for the file on the command line: the default of -y, or an empty text."""
    command = next((word for word in words if not word.startswith("-")), "")
    files = [Path(word) for word in words if word.endswith((".toml", ".vines")) and Path(word).is_file()]
    if command not in WITH_Y or not files:
        return ""
    try:
        name = _default(files[0])
    except (ValueError, OSError):
        return ""  # the command itself will report what is wrong with the file
    return f"For {files[0]} the default of -y is {name}.\n" if name else ""


def _default(path: Path) -> str:
    """Return the default measure of the pictures of a study or graph."""
    if path.suffix == ".vines":
        from ..graph import Graph
        from ..graph.stretches import default_measure
        from ..store import load

        graph = load(path)
        return default_measure(graph) if isinstance(graph, Graph) else ""
    from .study import read_study

    study = read_study(path)
    if study.sort is Sort.FLOW:
        return next(iter(study.flow.of_states))
    return flow_of(study.model).default_measure(study.model)
