"""From a study's `[survey]` to its plan, its family of machines, its outcomes and their units."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.design import Family
from orbits.machines.varying import Varying
from orbits.orbit import Orbit
from orbits.words import Word

from ..flows.files import FlowFamily
from ..flows.problem import FlowProblem
from ..shared.files import module_of
from ..shared.near_names import did_you_mean
from .own_study import own_code
from .study import check_range
from .study_data import Sort, Study, refused

if TYPE_CHECKING:
    from orbits.machines.physical.machine import Physical

    from ..survey.outcomes import Findings, Outcome
    from ..survey.plan import Plan


WRITTEN = (Sort.PAGE, Sort.FLOW)  # studies with equations in a Python file
TEXTS = ("within", "values", "normal", "uniform")


def plan_and_machine(study: Study) -> tuple[Plan, Any]:
    """Return the plan of a study's survey, and the machine as given by the parameters that vary.

    Raises
    ------
    ValueError
        If the plan is invalid; the message names the field and the value, and suggests a remedy.
    """
    from orbits.machines.physical.quantities import near_quantity

    from ..survey import planned
    from .compose import machine

    vary = dict(study.survey.vary)
    model = study.flow if study.sort is Sort.FLOW else machine(study)
    names = [*names_of(study), *study.conditions]
    follows = {table.parameter: table.condition for table in study.tables}
    for name in vary:
        if name in follows:
            raise ValueError(
                f"{study.path}: [survey] vary.{name}: {name} depends on {follows[name]}; vary {follows[name]}, or give {name} one number in [model]."
            )
        if name not in names:
            raise ValueError(
                f"{study.path}: [survey] vary.{name}: the model {study.name!r} has no such parameter"
                f"{near_quantity(name, names)}; it has {', '.join(names)}."
            )
        if name == study.parameter:
            raise ValueError(
                f"{study.path}: [survey] vary.{name}: every diagram runs over {name} already; vary something else."
            )
        if study.sort is Sort.PHYSICAL and name not in study.conditions:
            model = model.given_by(name)
            vary[name] = _numbers(model, name, vary[name], f"{study.path}: [survey] vary.{name}")
    with refused(str(study.path)):
        plan = planned(vary, study.survey.sampling, study.survey.samples, study.survey.seed)
        for name, values in {**plan.axes, **plan.samples}.items():
            check_range(study.tables, name, values.tolist(), f"[survey] vary.{name}")
        if study.sort is Sort.PAGE:
            for name, values in plan.axes.items():  # not samples: an impossible one gets a row with a note
                for value in values.tolist() if name not in study.conditions else ():
                    with refused(f"[survey] vary.{name}"):
                        model.check_value(name, value)
    return plan, model


def names_of(study: Study) -> Iterable[str]:
    """Return the names of all parameters of a study's machine that may vary."""
    if study.sort is Sort.CATALOGUE:
        return [entry.name for entry in study.model.settable]
    return study.model.tables.quantities if study.sort is Sort.PHYSICAL else study.parameters


def family_of(study: Study, model: Varying | FlowProblem) -> Family | FlowFamily:
    """Return the family of machines, or of flows, for a study's survey."""
    if study.sort is Sort.FLOW:
        assert isinstance(model, FlowProblem) and model.origin is not None
        file, name, _ = model.origin
        return FlowFamily(file, name, study.parameter, study.parameters, study.state, model.box)
    assert isinstance(model, Varying)
    return machines_of(study, model)


def machines_of(study: Study, model: Varying) -> Family:
    """Return the family of machines for a study's survey."""
    return Family(
        model, study.start.word, study.start.periods, study.start.guess, study.loose, study.parameter, study.within,
        study.state, study.tables,
    )  # fmt: skip


def outcomes_of(study: Study) -> list[Outcome]:
    """Return the outcome functions of a study's survey: general ones, those of machines, and the user's.

    Raises
    ------
    ValueError
        If a name or a file is unknown.
    """
    return [_outcome(study, name) for name in _spelled(study)]


def _outcome(study: Study, name: str) -> Outcome:
    from orbits.machines.measures import way_out

    from ..survey.survey import outcome_named
    from .compose import measures_of

    place, names = f"[survey] outcomes: {name!r}", measures_of(study)
    file, _, function = name.rpartition(":")
    measure = name.removeprefix("largest:")
    with refused(str(study.path)):
        if name.startswith("share:") and not (study.survey.atlas or study.survey.values):
            raise ValueError(
                f"{place} is a share of simulated starts, and there are none: with atlas = true an atlas of each "
                "machine is made, with values = 9 and starts = 16 each is simulated at nine values"
            )
        if measure != name and measure not in names:
            raise ValueError(
                f"{place}: there is no such measure{way_out(measure) or did_you_mean(measure, names)}; "
                f"choose one of {', '.join(names)}"
            )
        if file.endswith(".py"):
            path = own_code(study.path, file, place)
            if not path.is_file():
                raise ValueError(f"[survey] outcomes: there is no file {path}")
            own = UserOutcome(str(path.resolve()), function)
            if not callable(own.loaded):
                raise ValueError(f"[survey] outcomes: {path} has no function {function!r}")
            return own
        if study.sort in WRITTEN and name in OWN and not (name == "dissipation" and "impact_loss" in names):
            raise ValueError(
                f"{place} is known for the built-in machines (dissipation also by a declared machine with energy=); for equations of "
                'your own give a function of your own: "file.py:function"'
            )
        return outcome_named(name, OWN)


def _spelled(study: Study) -> list[str]:
    """Return the names of a survey's outcomes, with words of built-in machines rotated to the spelling that tables use.

    Raises
    ------
    ValueError
        If the word of a motion in an outcome is impossible.
    """

    if study.sort in WRITTEN:
        return study.survey.outcomes
    model, params = study.model, study.model.vector(study.loose)
    found = []
    for name in study.survey.outcomes:
        kind, _, text = name.partition(":")
        if kind in ("stable", "share") and text:
            try:
                word = Word.parse(text, frictionless=model.frictionless(params))
                name = f"{kind}:{word.spelled(model.has_mirror(params, study.parameter))}"
            except ValueError as error:  # the outcome `share` accepts a kind of motion, too
                if kind == "stable":
                    raise ValueError(f"{study.path}: [survey] outcomes: {name!r}: {error}.") from None
        found.append(name)
    return found


def asked_of(study: Study) -> dict[str, Any]:
    """Return everything besides the plan that determines the rows of a study's survey, JSON-able."""
    survey = study.survey.model_dump(exclude={"vary", "atlas"})
    budget = {} if study.atlas.budget is None else {"budget": study.atlas.budget}
    atlas = {"atlas": {**study.atlas.of_results(), **budget}} if study.survey.atlas else {}
    return {"study": study.describe(), "survey": survey, **atlas}


def ways_of(study: Study) -> dict[str, Any]:
    """Return the arguments of `contvines.survey` about simulations and atlases that a study sets."""
    numbers = {key: getattr(study.survey, key) for key in ("gaps", "values", "starts")}
    return {**numbers, "atlas": study.atlas.model_dump() if study.survey.atlas else None}


def units_of(study: Study, model: Varying | FlowProblem) -> dict[str, str]:
    """Return the units of parameters and outcomes, by name."""
    from orbits.flows import flow_of

    if not isinstance(model, Varying) or not model.units:
        return {}
    over = model.units.get(study.parameter, "")
    unit = model.units.get(flow_of(model).default_measure(model), "")
    responses = "peak", "lower_peak", "modulated_low", "modulated_mean", "modulated_high"
    places = "peak_at", "lower_peak_at", "activation_from_below", "activation_from_above"
    units = model.units | dict.fromkeys(responses, unit) | UNITS | dict.fromkeys(places, over)
    for name in _spelled(study):
        kind, _, rest = name.partition(":")
        if kind == "stable":
            units |= dict.fromkeys((f"stable_{rest}", f"stable_{rest}_from", f"stable_{rest}_to"), over)
        elif kind == "first":
            units[f"first_{rest}"] = over
        elif kind == "largest":
            units |= {f"largest_{rest}": model.units.get(rest, ""), f"largest_{rest}_at": over}
    return units


@dataclass(frozen=True)
class UserOutcome:
    """An outcome that is a function of the user's Python file; the file is run where it is called, also in worker processes."""

    path: str
    function: str

    @property
    def loaded(self) -> Callable[[Findings], Mapping[str, float] | float] | None:
        """Run the file and return the function; None if the file lacks it."""
        with refused("[survey] outcomes"):
            return getattr(module_of(self.path), self.function, None)

    def __call__(self, found: Findings) -> Mapping[str, float]:
        assert self.loaded is not None
        value = self.loaded(found)
        return value if isinstance(value, Mapping) else {self.function: float(value)}


def _numbers(model: Physical, name: str, given: object, place: str) -> object:
    """Convert quantities in a specification of `vary` to numbers in the machine's unit."""
    from .physical_study import number_of

    def read(values: object, path: str, spread: int | None = None) -> object:
        if not isinstance(values, list):
            return values
        return [number_of(model, name, value, f"{path}[{i}]", i == spread) for i, value in enumerate(values)]

    if not isinstance(given, dict):
        return read(given, place)
    return {
        key: read(value, f"{place}.{key}", 1 if key == "normal" else None) if key in TEXTS else value
        for key, value in given.items()
    }


def dissipation(found: Findings) -> dict[str, float]:
    """Return the power dissipated by impacts and by friction at the largest stable response of the diagram; nan for a declared machine without ``energy=``."""
    from ..survey.outcomes import highest, stretches

    top = highest(stretches(found.graph))
    if top is None or "impact_loss" not in top.stretch.branch.measure_names:
        return {"impact_power": np.nan, "friction_power": np.nan}
    orbit = top.stretch.branch.orbit(top.place)
    assert isinstance(orbit, Orbit)
    seconds = orbit.period * float(orbit.model.gauge("time", orbit.params))
    share = seconds * (0.001 if orbit.model.units.get("impact_loss") == "J" else 1.0)  # shown in mW
    return {f"{name}_power": orbit.measure(f"{name}_loss") / share for name in ("impact", "friction")}


def pumping(found: Findings) -> dict[str, float]:
    """Return the time in which a free decay loses nine tenths of its energy, and the absorber's share of the loss.

    The decay begins at the largest stable response of the diagram as displacement, with the absorber at rest in the middle of its cavity.
    """
    from orbits.design.transients import free_decay
    from orbits.machines.base import Model

    from ..survey.outcomes import peak

    seed = found.seed
    assert isinstance(seed, Orbit)
    model = seed.model
    assert isinstance(model, Model)
    height = peak(found)["peak"] / float(model.gauge("length", seed.params))
    if not np.isfinite(height):
        return {"pumping_time": np.nan, "pumped_share": np.nan}
    decay = free_decay(model, seed.params, height)
    return {
        "pumping_time": decay.pumping_time * float(model.gauge("time", seed.params)),
        "pumped_share": decay.absorber_share,
    }


OWN: dict[str, Outcome] = {"dissipation": dissipation, "pumping": pumping}
UNITS = {"impact_power": "mW", "friction_power": "mW", "pumping_time": "s"}
