"""The machines among which `contvines recommend` chooses: their diagrams and simulations, and the data about the chosen one."""

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
from .recommendation import AGREES, LOADS, MOTION_KINDS, Curve, Start
from .study_data import Sort, Study
from .survey_study import asked_of

if TYPE_CHECKING:
    from orbits.machines.varying import Varying

    from ..survey import Survey
    from ..survey.completion import Unbranched
    from ..survey.outcomes import Findings

PLACES = 13  # number of values in the first round
ENOUGH = 5  # number of values on a study's grid from which on the first round uses these instead
# parts of the names of parameters that are usually chosen
CLEARANCES = ("clearance", "gap", "width", "distance")
SAMPLES = 16  # default number of samples
REPLAYED, LONGEST = (
    400,
    24,
)  # forcing periods: of a motion simulated from itself, of the longest that may recur
CHECK = 61  # number of values of the simulations up and down
SWEPT = 25  # number of simulated values, instead of a diagram, for a machine whose flights are integrated
# default range of the values, relative to the largest clearance of the theory
SPREAD = (0.1, 1.25)
# the simulation is refined this many steps to either side of the largest response, with this number of values
FINE_STEPS, FINE = 8, 321
ROUGH = 33  # number of these values if flights are integrated
DRAWN = 4000  # number of stored instants of the start-up
MODULATED = ("chaotic", "quasi-periodic", "slow")


def loads(found: Findings) -> dict[str, float]:
    """Return the largest value of each load over the stable branches and the motions without a branch."""
    values_of = {
        name: [float(motion.measures.get(name, math.nan)) for motion in found.unbranched] for name in LOADS
    }
    for part in stretches(found.graph):
        for name in LOADS:
            if name in part.branch.measure_names:
                values_of[name] += list(part.branch.measure(name)[part.first : part.last + 1])
    return {name: largest(values) for name, values in values_of.items()}


def met(found: Findings) -> dict[str, float]:
    """Return the share of each kind in `MOTION_KINDS` among the simulated motions, and the largest response of each kind, branches included."""
    from ..graph.stretches import default_measure

    name = default_measure(found.graph)
    kinds = [_kind(measures, text) for _, measures, text in found.simulated]
    tops: dict[str, list[float]] = {kind: [] for kind in MOTION_KINDS}
    for kind, (_, measures, _) in zip(kinds, found.simulated):
        tops[kind].append(measures.get(name, math.nan))
    for one in found.unbranched:
        tops[_kind(one.measures, one.kind)].append(one.measures.get(name, math.nan))
    for part in stretches(found.graph):
        tops["impacts" if part.branch.description.get("impacts") else "calm"] += list(part.response)
    shares = {f"met_{kind}": kinds.count(kind) / len(kinds) if kinds else math.nan for kind in MOTION_KINDS}
    return shares | {f"{kind}_peak": largest(values) for kind, values in tops.items()}


def _kind(measures: Mapping[str, float], text: str) -> str:
    """Return the kind of a simulated motion, a key of `MOTION_KINDS`."""
    if text == "stuck":
        return "stuck"
    if text in MODULATED or modulation_of(measures):
        return "modulated"
    return "calm" if measures.get("impacts_per_period", math.nan) == 0.0 else "impacts"


def largest(values: Sequence[float] | np.ndarray) -> float:
    """Return the largest finite number; nan if there is none."""
    values = np.asarray(values, dtype=float)
    return float(values[np.isfinite(values)].max(initial=-np.inf)) if np.isfinite(values).any() else math.nan


def tidy(value: float) -> float:
    """Round a value to four digits, more than anybody manufactures."""
    return float(f"{value:.4g}")


@dataclass
class Machines:
    """The machines of a study among which one is chosen, with the computations on them.

    Attributes
    ----------
    study : Study
    cost : float
        Relative increase of the worst response that is allowed within the tolerance.
    workers : int, optional
        Number of processes.
    journal : callable
        Returns the file for the rows of a round.
    tell : callable
        Called with messages about the progress.
    progress : bool
        Whether to show the progress of each round.
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
                raise ValueError(_advice(study, names))
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
        self.pace: float | None = None  # seconds per machine
        self.surveys = 0

    @property
    def known(self) -> Mapping[str, float]:
        """The parameter values of the study."""
        return getattr(self.model, "quantities", None) or self.study.parameters

    def range(self) -> list[float]:
        """Return the values of the first round, with the study's own value if it lies in the range."""
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
        """Compute the survey of a plan; its rows are stored in the journal of the round."""
        from ..survey.survey import survey
        from .survey import without_main

        self.surveys += 1
        began = monotonic()
        options = {**self.study.options, "depth": 0}  # simulation also finds the motions that leave a branch
        with without_main():
            found = survey(
                self.family, plan, over=self.study.parameter, within=self.study.within, outcomes=outcomes, workers=self.workers,
                journal=self.journal(self.surveys), units=self.units, about={"recommend": self.surveys, "ways": list(ways), **asked_of(self.study)},
                progress=self.progress, gaps=self.study.survey.gaps, **ways, **options,
            )  # fmt: skip
        self.pace = (monotonic() - began) / len(plan)
        return found

    # ------------------------------------------------------------------ told of the choice
    def described(self) -> dict[str, str]:
        """Return the study's parameters as text, with the distributions of uncertain ones."""
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
        """Return the largest response of the study's machine at the choice by its diagram and by simulation, and the response curves.

        The simulation starts on the motion with the largest response, at a value next to that of the maximum; simulations up and down
        count if they find a larger response.
        """
        from orbits.attractors.search import beginning_with
        from orbits.attractors.sweeping import sweep

        from ..survey.work import Job, work

        over, (low, high) = self.study.parameter, self.study.within
        curves: list[Curve] = []
        compared: list[tuple[float, float]] = []
        measure = flow_of(model).default_measure(model)
        loose: dict[str, Any] = {k: v for k, v in own.items() if k != over}

        def response_of(one: Unbranched) -> float:
            response = one.measures.get(measure, math.nan)
            return response if math.isfinite(response) else -math.inf

        def keep(found: Findings) -> dict[str, float]:
            parts = stretches(found.graph)
            curves.extend(Curve("stable", part.values.tolist(), part.response.tolist()) for part in parts)
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
            return None, curves
        step, top = (high - low) / (CHECK - 1), columns["peak_at"]
        near = max(low, top - FINE_STEPS * step), min(high, top + FINE_STEPS * step)
        closer = np.linspace(*near, ROUGH if self.integrated else FINE)
        grid = np.union1d(np.linspace(low, high, CHECK), closer)
        most = -math.inf
        for run in (grid, grid[::-1]):
            rows = sweep(model, over, run, nudge=0.0, **loose)
            curves.append(Curve("simulated", [r.value for r in rows], [r.measures[measure] for r in rows]))
            most = max(most, *curves[-1].y)
        largest = columns["peak"]  # of motions without a branch, too
        if not compared or compared[0][0] < (1.0 - AGREES) * largest or most > (1.0 + AGREES) * largest:
            return (largest, most), curves
        return compared[0], curves

    def compared(self, model: Varying) -> list[Curve]:
        """Return the responses of the machines to compare with; declared machines have none."""
        from orbits.machines.base import Model

        from .plot import POINTS, response_of

        if not isinstance(model, Model):
            return []
        values = np.linspace(*self.study.within, POINTS)
        params = np.array([model.vector_at(self.study.parameter, float(x), self.study.loose) for x in values])
        return [Curve(kind, values.tolist(), response_of(kind, model, params).tolist()) for kind in KINDS]

    def start_up(self, model: Varying, at: float) -> Start:
        """Return the start-up from rest at a value of the parameter."""
        from orbits.design.transients import start_up

        from .measured import Scales

        over = self.study.parameter
        params = model.vector_at(over, at, self.study.loose)
        scales = Scales(model, params)
        length, seconds = scales.factor("length"), scales.factor("time")
        motion = start_up(model, params)
        self.assumed.append(
            f"start-up from rest at {over} = {figures(at)} {self.units.get(over, '')}".rstrip()
            + ", where the bare machine moves most"
        )
        thin = slice(None, None, max(1, len(motion.times) // DRAWN))
        series = {
            "time": motion.times * seconds,
            "oscillator": motion.oscillator * length,
            "bare": motion.bare * length,
        }
        return Start(
            peak=float(np.abs(series["oscillator"]).max()),
            bare_peak=float(np.abs(series["bare"]).max()),
            settled=motion.settled * seconds,
            bare_settled=motion.bare_settled * seconds,
            fastest_impact=float(motion.impact_speeds.max(initial=0.0)) * scales.factor("velocity"),
            worst_relative=float(np.abs(motion.relative).max()) * length,
            series={name: values[thin].tolist() for name, values in series.items()},
        )


def _advice(study: Study, names: Sequence[str]) -> str:
    """Return advice for a study without a parameter to choose: a range without ``count`` means that a value is uncertain."""
    ranges = {
        name: value["within"]
        for name, value in study.survey.vary.items()
        if isinstance(value, dict) and "within" in value
    }
    default = next((name for name in names if any(word in name for word in CLEARANCES)), names[0])
    name = next(iter(ranges), default)
    within = json.dumps(ranges[name]) if ranges else "[from, to]"
    reason = "[survey] vary needs one parameter with a range"
    if ranges:
        reason = f"vary.{name} without count is uncertain"
    return f"{study.path}: what is to be chosen? {reason}; for example vary.{name} = {{ within = {within}, count = {PLACES} }}."
