"""Where the two packages meet: a study becomes a machine, a first orbit and a run."""

import sys
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contvines.text_table import fitted

if TYPE_CHECKING:
    from contvines.command.study import Study
    from contvines.graph.graph import Graph


class Interrupted(Exception):
    """Ctrl-C in the middle of the work; the message says what is kept and how to go on."""


def checked_study(path: Path) -> "Study":
    """A study whose values, machine and word can all be; see `read_study`.

    Raises
    ------
    ValueError
        With a sentence that names the file, the field, the value and what would do.
    """
    from contvines.command.own_kinds import load_kinds
    from contvines.command.study import read_study
    from orbits.words import Word

    study = read_study(path)
    if study.kinds is not None:
        try:
            load_kinds(path, study.kinds)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from error
    if study.flow is not None:
        return study
    try:
        model = machine(study)
        vector = model.vector(loose(study))
    except ValueError as error:
        raise ValueError(f"{path}: [model] {error}") from error
    if study.machine is not None:
        return study
    try:
        Word.parse(study.word or "", frictionless=model.frictionless(vector))
    except ValueError as error:
        raise ValueError(f"{path}: [start] {error}") from error
    return study


def check_shaken(study: "Study", vary: Iterable[str] = ()) -> None:
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
    if study.machine is not None or study.flow is not None:
        return
    model = machine(study)
    unshaken = model.unshaken(model.vector(loose(study)))
    if unshaken is not None and not any(map(model.shakes, (study.parameter, *vary))):
        zero, would = unshaken
        raise ValueError(
            f"{study.path}: {zero}: nothing shakes the machine, whatever {study.parameter} is; {would} would do."
        )


def machine(study: "Study") -> Any:
    """The machine of a study, `[start]`'s overrides included.

    Raises
    ------
    ValueError
        If it is a study of a flow, which is no machine.
    """
    from orbits.machines.building import build

    if study.flow is not None:
        raise ValueError(
            f"{study.path}: this command needs a machine; of the flow {study.name!r} there are contvines diagram, trace, atlas, basins and "
            "orbit, and of the file that they write plot, show, switch, locus, chart, circle, report and export"
        )
    if study.machine is not None:
        return study.machine
    if study.quantities:
        return build(study.quantities)
    own = {k: v for k, v in study.parameters.items() if k not in loose(study)}
    return build({"name": study.name, **own})


def population(study: "Study") -> Any:
    """Starts of a study's machine or flow, and what they settle on, over its parameter."""
    if study.flow is not None:
        fixed = {name: value for name, value in study.parameters.items() if name != study.parameter}
        return study.flow.population(study.parameter, box=study.box, **fixed)
    from contvines.coexistence.population import population_of

    fixed = {name: value for name, value in loose(study).items() if name != study.parameter}
    return population_of(machine(study), study.parameter, **fixed)


def loose(study: "Study") -> dict[str, float]:
    """Parameters that belong to the orbit rather than to the machine (the reduced model's amplitude)."""
    from orbits.machines.catalogue import model_class

    if study.machine is not None:
        return study.loose
    if study.quantities:
        return {}
    own = model_class(study.name).field_names()
    return {k: v for k, v in study.parameters.items() if k not in own}


def first_orbit(study: "Study") -> Any:
    """The study's start, solved.

    Raises
    ------
    ValueError
        If the word cannot be, or no orbit with it is found; the sentence names the study.
    """
    if study.flow is not None:
        from contvines.command.flow_study import seed_of

        try:
            return seed_of(study)
        except ValueError as error:
            raise ValueError(f"{study.path}: [start] {error}") from error
    from orbits.starts.find import StartWarning

    try:
        if study.word is None and study.machine is not None:
            return machine(study).attractor(study.state, **loose(study)).found
        if study.word is None:
            return _settled(study)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("ignore")
            warnings.simplefilter("always", StartWarning)
            orbit = machine(study).orbit(study.word, study.periods, guess=study.guess, **loose(study))
        for warning in caught:
            print(f"contvines: {study.path}: [start] {warning.message}.", file=sys.stderr)
        return orbit
    except ValueError as error:
        raise ValueError(f"{study.path}: [start] {error}") from error


def _settled(study: "Study") -> Any:
    """The motion that settles from rest, where the study begins or elsewhere in its interval; told on stderr."""
    from contvines.graph.shortening import short_word
    from orbits.design import Family

    model = machine(study)
    orbit = Family(model, loose=loose(study), over=study.parameter, within=study.within)({})
    amount = orbit.model.amount(study.parameter, orbit.params)
    unit = model.units.get(study.parameter, "")
    print(
        f"contvines: {study.path}: [start] has no word; begun with the motion that settles from rest at {study.parameter} = "
        + f"{amount:g} {unit}".rstrip()
        + f": {short_word(orbit.word.text) if len(orbit.word) else 'the absorber does not move in its cavity'}.",
        file=sys.stderr,
    )
    return orbit


def kinds_of(study: "Study") -> Any:
    """The kinds of special points that a study looks for; None where it names none of its own."""
    if study.kinds is None:
        return None
    from contvines.command.own_kinds import load_kinds

    return load_kinds(study.path, study.kinds)[0]


def run_diagram(study: "Study", seed: Any, **options: Any) -> "Graph":
    """The automatic diagram of a study from its first orbit; options as for `contvines.diagram`."""
    import contvines

    asked = {
        "depth": study.depth,
        "virtual": study.virtual,
        "settings": study.settings,
        "bounds": study.bounds,
        "kinds": kinds_of(study),
    }
    return contvines.diagram(seed, over=study.parameter, within=study.within, **{**asked, **options})


def run_atlas(study: "Study", seed: Any, **options: Any) -> "Graph":
    """The atlas of a study's starts; options as for `contvines.atlas`."""
    import contvines

    asked = {
        "depth": study.depth,
        "virtual": study.virtual,
        "settings": study.settings,
        "kinds": kinds_of(study),
    }
    return contvines.atlas(seed, within=study.within, **study.atlas.model_dump(), **{**asked, **options})


def beside(path: Path, ending: str) -> Path:
    """The default place of a result: the study's or file's name with another ending, in the current folder."""
    return Path(path.stem + ending)


def check_place(path: Path) -> None:
    """Refuse, before any work, a graph that could not be written at the end, or not under this name."""
    from contvines.file_names import refuse_ending

    if path.is_dir():
        raise ValueError(f"{path}: this is a folder; give the name of a file with -o.")
    if not path.parent.is_dir():
        raise ValueError(
            f"{path}: there is no folder {str(path.parent)!r}; make it first, or choose another place."
        )
    refuse_ending(path, "vines")


def say(text: str, quiet: bool = False) -> None:
    """A remark for the user, on stderr so that results on stdout stay clean."""
    if not quiet:
        print(fitted(text), file=sys.stderr)
