"""The machines among which `contvines recommend` chooses: their diagrams and simulations, and what is told of the chosen one."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.design.references import KINDS
from orbits.flows import flow_of
from orbits.orbit import Orbit

from ..graph.stretches import highest, inside
from ..shared.motions import modulation_of
from ..shared.numbers import figures
from ..survey.outcomes import peak, stretches
from ..survey.plan import Plan
from .recommendation import AGREES, LOADS, MET, Curve, Start
from .study_data import Sort, Study
from .survey_study import asked_of

if TYPE_CHECKING:
    from orbits.machines.varying import Varying

    from ..survey import Survey
    from ..survey.completion import Unbranched
    from ..survey.outcomes import Findings

PLACES = 13  # values of the first look
ENOUGH = 5  # values on the grid of a study, from which on these are looked at in place of them
CLEARANCES = ("clearance", "gap", "width", "distance")  # in names of what is usually chosen
SAMPLES = 16  # where the study does not say
REPLAYED, LONGEST = (
    400,
    24,
)  # forcing periods: of a motion simulated from itself, of the longest that may recur
CHECK = 61  # values of the simulation up and down
SWEPT = 25  # values at which a machine whose flights are integrated is simulated in place of a diagram
SPREAD = (0.1, 1.25)  # of the first clearance's widest: where it is looked at if the study gives no range
ABOUT, FINE = 8, 321  # steps to either side of the largest response where it looks closer, at so many values
ROUGH = 33  # the same where flights are integrated
DRAWN = 4000  # instants of the start-up that are kept
MODULATED = ("chaotic", "quasi-periodic", "slow")


def loads(found: Findings) -> dict[str, float]:
    """The largest of each load over the stable motions; the speed of impacts over simulated ones, too."""
    known = {name: [float(met.measures.get(name, math.nan)) for met in found.unbranched] for name in LOADS}
    for part in stretches(found.graph):
        for name in LOADS:
            if name in part.branch.measure_names:
                known[name] += list(part.branch.measure(name)[part.first : part.last + 1])
    return {name: largest(values) for name, values in known.items()}


def met(found: Findings) -> dict[str, float]:
    """Shares of the simulated motions by what they are (with impacts and a period, modulated or chaotic, without impacts, stuck), and the
    largest response of each, that of the branches included."""
    from ..graph.stretches import default_measure

    name = default_measure(found.graph)
    kinds = [_kind(measures, text) for _, measures, text in found.simulated]
    tops: dict[str, list[float]] = {kind: [] for kind in MET}
    for kind, (_, measures, _) in zip(kinds, found.simulated):
        tops[kind].append(measures.get(name, math.nan))
    for one in found.unbranched:
        tops[_kind(one.measures, one.kind)].append(one.measures.get(name, math.nan))
    for part in stretches(found.graph):
        tops["impacts" if part.branch.description.get("impacts") else "calm"] += list(part.response)
    shares = {f"met_{kind}": kinds.count(kind) / len(kinds) if kinds else math.nan for kind in MET}
    return shares | {f"{kind}_peak": largest(values) for kind, values in tops.items()}


def _kind(measures: Mapping[str, float], text: str) -> str:
    """What a simulated motion is, one of `MET`."""
    if text == "stuck":
        return "stuck"
    if text in MODULATED or modulation_of(measures):
        return "modulated"
    return "calm" if measures.get("impacts_per_period", math.nan) == 0.0 else "impacts"


def largest(values: Sequence[float] | np.ndarray) -> float:
    """The largest number; no number where there is none."""
    values = np.asarray(values, dtype=float)
    return float(values[np.isfinite(values)].max(initial=-np.inf)) if np.isfinite(values).any() else math.nan


def tidy(value: float) -> float:
    """A value of four digits: nobody builds more."""
    return float(f"{value:.4g}")


@dataclass
class Machines:
    """The machines of a study of which one is chosen, and what is asked of them.

    Attributes
    ----------
    study : Study
    cost : float
        The share by which the worst response may be higher within the tolerance.
    workers : int, optional
        Processes.
    journal : callable
        Round -> file of its rows.
    tell : callable
        Takes sentences.
    progress : bool
    """

    study: Study
    cost: float
    workers: int | None
    journal: Callable[[int], Path | None]
    tell: Callable[[str], None]
    progress: bool

    def __post_init__(self) -> None:
        from orbits.design.references import first_clearance

        from ..coexistence.census import population_of
        from .compose import check_shaken, machine
        from .survey_study import machines_of, plan_and_machine, units_of

        study = self.study
        if study.sort is Sort.FLOW:
            raise ValueError(
                f"{study.path}: contvines recommend is for machines; contvines survey --best chooses of flows."
            )
        if "samples" not in study.survey.model_fields_set:
            self.study = study = study.having("survey", samples=SAMPLES)
        check_shaken(study, study.survey.vary)
        self.assumed: list[str] = []
        if study.survey.vary:
            self.plan, model = plan_and_machine(study)
        else:
            self.plan, model = Plan({}, {}), machine(study)
            self.assumed.append(
                "nothing is uncertain, as [survey] vary names nothing: the choice is for the study's own numbers"
            )
        axes = self.plan.axes
        if len(axes) > 1:
            raise ValueError(
                f"{study.path}: [survey] vary has {' and '.join(axes)} on a grid: contvines recommend chooses one; "
                "make the others uncertain (uniform = [from, to]), or leave them out. contvines survey --best chooses two."
            )
        self.name, names = next(iter(axes), "half_width"), list(model.amount_names)
        if not axes:
            if study.sort is not Sort.PHYSICAL or self.name not in names:
                raise ValueError(_what(study, names))
            model = model.given_by(self.name)
        self.model, self.family, self.units = model, machines_of(study, model), units_of(study, model)
        self.drawn = self.plan.samples
        self.samples = self.plan.shape[-1] if self.drawn else 1
        self.damped = "damping" in model.parameter_names
        by_theory = self.name == "half_width" and self.damped
        self.theory = first_clearance(model, model.vector(study.loose)) if by_theory else None
        self.integrated = population_of(model, study.parameter, **study.loose).price > 1.0
        if self.integrated:
            self.assumed.append(
                f"responses elsewhere than at the choice are those of simulations up and down at {SWEPT} values and from drawn starts: "
                "a motion to which few starts lead is not among them"
            )
        self.pace: float | None = None  # seconds a machine
        self.surveys = 0

    @property
    def known(self) -> Mapping[str, float]:
        """The study's own numbers."""
        return getattr(self.model, "quantities", None) or self.study.parameters

    def range(self) -> list[float]:
        """The values of the first look, the study's own among them where it lies in the range."""
        own = self.known.get(self.name)
        if self.plan.axes:
            given = self.plan.axes[self.name]
            low, high = float(given.min()), float(given.max())
            values = given.tolist() if len(given) >= ENOUGH else np.linspace(low, high, PLACES).tolist()
            if own is not None and not low <= own <= high:
                own = None
        elif self.theory is None:
            raise ValueError(
                f"{self.study.path}: [survey] gives no range of {self.name}, and theory none for this machine; for example "
                f'vary.{self.name} = {{ within = ["5 mm", "50 mm"], count = {PLACES} }}.'
            )
        else:
            low, high = (share * self.theory.widest for share in SPREAD)
            values = np.geomspace(low, high, PLACES).tolist()
            self.assumed.append(
                f"[survey] gives no range of {self.name.replace('_', ' ')}: looked at from {low:.3g} to {high:.3g} {self.units.get(self.name, '')}".rstrip()
                + f", {SPREAD[0]:g} to {SPREAD[1]:g} times the widest by theory"
            )
        return sorted({*map(tidy, values), *([] if own is None else [float(own)])})

    def surveyed(self, plan: Plan, outcomes: Sequence[Any], **ways: Any) -> Survey:
        """The rows of a plan, kept in the journal of the round."""
        from ..survey.survey import survey
        from .survey import without_main

        self.surveys += 1
        begun = monotonic()
        options = {**self.study.options, "depth": 0}  # what leaves a branch is met by simulation, too
        with without_main():
            found = survey(
                self.family, plan, over=self.study.parameter, within=self.study.within, outcomes=outcomes, workers=self.workers,
                journal=self.journal(self.surveys), units=self.units, about={"recommend": self.surveys, "ways": list(ways), **asked_of(self.study)},
                progress=self.progress, gaps=self.study.survey.gaps, **ways, **options,
            )  # fmt: skip
        self.pace = (monotonic() - begun) / len(plan)
        return found

    # ------------------------------------------------------------------ told of the choice
    def described(self) -> dict[str, str]:
        """The study's numbers as text, with what is uncertain."""
        units = self.model.units
        found = {
            name: f"{figures(value)} {units.get(name, '')}".rstrip() for name, value in self.known.items()
        }
        found.pop(self.study.parameter, None)
        for name, values in self.drawn.items():
            ends = f"{figures(values.min())} to {figures(values.max())} {units.get(name, '')}".rstrip()
            found[name] = f"{ends} in {len(values)} samples"
        if self.name in found:
            found[self.name] = f"chosen; {found[self.name]} in the study"
        return found

    def checked(
        self, value: float, model: Varying, own: dict[str, float]
    ) -> tuple[tuple[float, float] | None, list[Curve]]:
        """The largest response of the study's own machine at the choice, by its diagram and by simulation from that motion (at a value where it
        is next to the largest); of simulations up and down, if these meet more. The responses."""
        from orbits.attractors.search import beginning_with
        from orbits.attractors.sweeping import sweep

        from ..survey.work import Job, work

        over, (low, high) = self.study.parameter, self.study.within
        seen: list[Curve] = []
        compared: list[tuple[float, float]] = []
        measure = flow_of(model).default_measure(model)
        loose: dict[str, Any] = {k: v for k, v in own.items() if k != over}

        def response_of(one: Unbranched) -> float:
            response = one.measures.get(measure, math.nan)
            return response if math.isfinite(response) else -math.inf

        def keep(found: Findings) -> dict[str, float]:
            parts = stretches(found.graph)
            seen.extend(Curve("stable", part.values.tolist(), part.response.tolist()) for part in parts)
            top, most = highest(parts), -math.inf
            if top is not None:  # from itself: other starts may miss a motion that few of them lead to
                u, p, response = inside(top, 0.5 * AGREES)
                orbit = top.stretch.branch.attached.orbit(u, p)
                assert isinstance(orbit, Orbit)
                replayed, most = beginning_with(orbit, REPLAYED, LONGEST), top.response
                compared.append((response, replayed.get(measure, -math.inf)))
            free = max(found.unbranched, key=response_of, default=None)
            if free is not None and free.state is not None and response_of(free) > most:
                (longer,) = sweep(
                    model, over, [free.value], start=free.state, transient=REPLAYED, nudge=0.0, exponents=False, **loose
                )  # fmt: skip
                compared[:] = [(response_of(free), longer.measures[measure])]
            return peak(found)

        job = Job(self.family, over, (low, high), (keep,), options={**self.study.options, "depth": 0})
        columns = work(job, 0, {self.name: value}).columns
        if not columns:
            return None, seen
        step, top = (high - low) / (CHECK - 1), columns["peak_at"]
        near = max(low, top - ABOUT * step), min(high, top + ABOUT * step)
        closer = np.linspace(*near, ROUGH if self.integrated else FINE)
        grid = np.union1d(np.linspace(low, high, CHECK), closer)
        most = -math.inf
        for run in (grid, grid[::-1]):
            rows = sweep(model, over, run, nudge=0.0, **loose)
            seen.append(Curve("simulated", [r.value for r in rows], [r.measures[measure] for r in rows]))
            most = max(most, *seen[-1].y)
        largest = columns["peak"]  # of motions without a branch, too
        if not compared or compared[0][0] < (1.0 - AGREES) * largest or most > (1.0 + AGREES) * largest:
            return (largest, most), seen
        return compared[0], seen

    def compared(self, model: Varying) -> list[Curve]:
        """Responses of the machines to compare with; declared machines have none."""
        from orbits.machines.base import Model

        from .plot import POINTS, response_of

        if not isinstance(model, Model):
            return []
        values = np.linspace(*self.study.within, POINTS)
        params = np.array([model.vector_at(self.study.parameter, float(x), self.study.loose) for x in values])
        return [Curve(kind, values.tolist(), response_of(kind, model, params).tolist()) for kind in KINDS]

    def start_up(self, model: Varying, at: float) -> Start:
        """The start-up from rest at a value of the parameter."""
        from orbits.design.transients import start_up

        from .measured import Scales

        over = self.study.parameter
        params = model.vector_at(over, at, self.study.loose)
        scales = Scales(model, params)
        length, seconds = scales.factor("length"), scales.factor("time")
        seen = start_up(model, params)
        self.assumed.append(
            f"start-up from rest at {over} = {figures(at)} {self.units.get(over, '')}".rstrip()
            + ", where the bare machine moves most"
        )
        thin = slice(None, None, max(1, len(seen.times) // DRAWN))
        series = {
            "time": seen.times * seconds,
            "oscillator": seen.oscillator * length,
            "bare": seen.bare * length,
        }
        return Start(
            peak=float(np.abs(series["oscillator"]).max()),
            bare_peak=float(np.abs(series["bare"]).max()),
            settled=seen.settled * seconds,
            bare_settled=seen.bare_settled * seconds,
            fastest_impact=float(seen.impact_speeds.max(initial=0.0)) * scales.factor("velocity"),
            worst_relative=float(np.abs(seen.relative).max()) * length,
            series={name: values[thin].tolist() for name, values in series.items()},
        )


def _what(study: Study, names: Sequence[str]) -> str:
    """What to write where nothing is to be chosen: a range without ``count`` only says that a value is uncertain."""
    said = {
        name: value["within"]
        for name, value in study.survey.vary.items()
        if isinstance(value, dict) and "within" in value
    }
    usual = next((name for name in names if any(word in name for word in CLEARANCES)), names[0])
    name = next(iter(said), usual)
    within = json.dumps(said[name]) if said else "[from, to]"
    why = "[survey] vary needs one parameter with a range"
    if said:
        why = f"vary.{name} without count is uncertain"
    return f"{study.path}: what is to be chosen? {why}; for example vary.{name} = {{ within = {within}, count = {PLACES} }}."
