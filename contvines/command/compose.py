"""Where the two packages meet: a study becomes a machine, a first orbit and a run."""

import sys
import warnings
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import contvines
from contvines.command.study_data import Sort, Study, without_word

if TYPE_CHECKING:
    from ..graph.graph import Graph


def machine(study: Study):
    """The machine of a study, `[start]`'s overrides included.

    Raises
    ------
    ValueError
        If it is a study of a flow, which is no machine.
    """
    if study.sort is Sort.FLOW:
        raise ValueError(
            f"{study.path}: this command needs a machine; of the flow {study.name!r} there are contvines diagram, trace, atlas, basins, "
            "survey and orbit, and of the file that they write plot, show, switch, locus, chart, circle, report and export"
        )
    return study.model


def check_shaken(study: Study, vary: Iterable[str] = ()) -> None:
    """Refuse a study in which nothing shakes the machine, whatever varies.

    Parameters
    ----------
    study : Study
    vary : iterable of str
        What varies beside the study's parameter.

    Raises
    ------
    ValueError
    """
    if study.sort not in (Sort.CATALOGUE, Sort.PHYSICAL):
        return
    unshaken = study.model.unshaken(study.model.vector(study.loose))
    if unshaken is not None and not any(map(study.model.shakes, (study.parameter, *vary))):
        zero, would = unshaken
        raise ValueError(
            f"{study.path}: {zero}: nothing shakes the machine, whatever {study.parameter} is; for example {would}."
        )


def population(study: Study):
    """Starts of a study's machine or flow, and what they settle on, over its parameter."""
    own = study.parameters if study.sort is Sort.FLOW else study.loose
    fixed = {name: value for name, value in own.items() if name != study.parameter}
    if study.sort is Sort.FLOW:
        return study.flow.population_at(fixed, study.parameter, study.box)
    from contvines.coexistence.population import population_of

    return population_of(study.model, study.parameter, **fixed)


def first_orbit(study: Study):
    """The study's start, solved.

    Raises
    ------
    ValueError
        If the word cannot be, or no orbit with it is found; the sentence names the study.
    """
    reduction = getattr(study.model, "reduction", None)
    if reduction is not None and reduction.error:
        print(f"contvines: {study.path}: [model] {reduction.sentence}.", file=sys.stderr)
    try:
        if study.sort is Sort.FLOW:
            if study.state is not None or study.flow.field.forced:
                return study.flow.attractor_at(study.parameters, study.state)
            return study.flow.equilibria(study.parameter, study.parameters)
        if study.sort is Sort.PAGE and study.word in (None, "") and not study.guess:
            return _page_start(study)
        if study.word is None:
            return _settled(study)
        from orbits.starts.find import StartWarning

        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("ignore")
            warnings.simplefilter("always", StartWarning)
            orbit = study.model.orbit(study.word, study.periods, guess=study.guess, **study.loose)
        for warning in caught:
            print(f"contvines: {study.path}: [start] {warning.message}.", file=sys.stderr)
        return orbit
    except ValueError as error:
        raise ValueError(f"{study.path}: [start] {without_word(study, error)}") from error


def _page_start(study: Study):
    """What the study's state leads to, elsewhere in its interval if nothing recurs here; of a self-excited machine that comes to rest, or with
    the word "", the equilibrium near it.
    """
    from contextlib import suppress

    from orbits.starts.find import StartError

    model, state = study.model, study.state
    if study.word == "" and model.forced:
        return model.orbit("", study.periods, **study.loose)
    if study.word is None:
        found = model.attractor(state, **study.loose)
        if not found.recurrent and (model.forced or found.kind == "aperiodic"):
            with suppress(StartError):
                return _settled(study)
        if found.kind != "rest" or found.trajectory.held or model.forced:
            return found.found
        state = dict(zip(model.states, map(float, found.state[1:]), strict=True))
    return model.smooth(state, **study.loose).equilibria(study.parameter)


def _settled(study: Study):
    """The motion that settles from rest, where the study begins or elsewhere in its interval; told on stderr."""
    from contvines.graph.shortening import short_word
    from orbits.design import Family

    orbit = Family(
        study.model, loose=study.loose, over=study.parameter, within=study.within, state=study.named_state
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


def _asked(study: Study) -> dict[str, Any]:
    """Options of diagrams and atlases that a study says."""
    kinds = None
    if study.kinds is not None:
        from contvines.command.own_code import load_kinds

        kinds = load_kinds(study.path, study.kinds)[0]
    return {"depth": study.depth, "virtual": study.virtual, "settings": study.settings, "kinds": kinds}


def run_diagram(study: Study, seed: object, **options: Any) -> "Graph":
    """The automatic diagram of a study from its first orbit; options as for `contvines.diagram`."""
    asked = {"bounds": study.bounds, **_asked(study)}
    return contvines.diagram(seed, over=study.parameter, within=study.within, **{**asked, **options})


def run_atlas(study: Study, seed: object, **options: Any) -> "Graph":
    """The atlas of a study's starts; options as for `contvines.atlas`."""
    asked = {**study.atlas.model_dump(), **_asked(study)}
    return contvines.atlas(seed, within=study.within, **{**asked, **options})
