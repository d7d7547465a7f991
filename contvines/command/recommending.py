"""A clearance for a study: by theory, by a first look over its range, then by diagrams of all samples ever nearer to the best."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from contvines.command.recommendation import AGREES, LOADS, MET, Curve, Jump, Place, Recommendation, Start
from contvines.command.study_data import Sort, Study
from contvines.command.survey_study import asked_of, options_of
from contvines.shared.files import digest_of
from contvines.shared.motions import BAND, modulation_of
from contvines.shared.number_text import figures
from contvines.survey.outcomes import stretches
from contvines.survey.plan import Plan
from orbits.design.references import KINDS
from orbits.flows.catalogue import flow_of

if TYPE_CHECKING:
    from contvines.survey import Survey
    from contvines.survey.completion import Unbranched
    from contvines.survey.outcomes import Findings
    from orbits.design.references import FirstClearance
    from orbits.machines.varying import Varying

PLACES = 13  # values of the first look
CLEARANCES = ("clearance", "gap", "width", "distance")  # in names of what is usually chosen
RESPONSES = ("peak", "lower_peak")  # what is asked of every machine
UNSEEN = "not looked at"  # a note
LATER = (7, 5)  # of the later ones, between the neighbours of the best
SAMPLES = 16  # where the study does not say
QUIETED = 0.9  # of the bare machine's response: a machine that is quieted less does not work
VALUES, STARTS = 9, 6  # of the parameter, and at each, from which it is told what is met at the choice
FEW = 2  # starts where flights are integrated
REPLAYED, LONGEST = (
    400,
    24,
)  # forcing periods of a motion simulated from itself, and of the longest that may recur
CHECK = 61  # values of the simulation up and down
SWEPT = 25  # values at which a machine whose flights are integrated is simulated in place of a diagram
TRIED = 5  # choices of such machines that are looked at by diagrams, until one is the best of all
SPREAD = (0.1, 1.25)  # of the first clearance's widest: where it is looked at if the study gives no range
ABOUT, FINE = 8, 321  # steps to either side of the largest response where it looks closer, at so many values
ROUGH = 33  # the same where flights are integrated
STEEP = 0.05  # of the value that is chosen: a rise within it counts as a jump
MARGIN = 0.02  # of the value that is chosen: nearer to a jump of the response another value is taken, if it costs no more than the tolerance
JUMP, HALVED = (
    0.2,
    4,
)  # of the response: such a rise beside the tolerance is looked at, and how often the distance is halved
DRAWN = 4000  # instants of the start-up that are kept


def loads(found: Findings) -> dict[str, float]:
    """The largest of each load over the stable motions; the speed of impacts over simulated ones, too."""
    largest: dict[str, float] = {}
    parts = stretches(found.graph)
    for name in LOADS:
        known = [float(met.measures.get(name, math.nan)) for met in found.unbranched]
        for part in parts:
            if name in part.branch.measure_names:
                known += np.asarray(part.branch.measure(name), dtype=float)[
                    part.first : part.last + 1
                ].tolist()
        largest[name] = max((x for x in known if math.isfinite(x)), default=math.nan)
    return largest


def met(found: Findings) -> dict[str, float]:
    """Shares of the simulated motions by what they are (with impacts and a period, modulated or chaotic, without impacts, stuck), and the
    largest response of each, that of the branches included."""
    from contvines.graph.measures import default_measure

    name = default_measure(found.graph)
    kinds = [_kind(measures, text) for _, measures, text in found.simulated]
    seen = [(kind, measures.get(name, math.nan)) for kind, (_, measures, _) in zip(kinds, found.simulated)]
    seen += [(_kind(one.measures, one.kind), one.measures.get(name, math.nan)) for one in found.unbranched]
    seen += [
        ("impacts" if part.branch.description.get("impacts") else "calm", float(np.nanmax(part.response, initial=-np.inf)))
        for part in stretches(found.graph)
    ]  # fmt: skip
    shares = {f"met_{kind}": kinds.count(kind) / len(kinds) if kinds else math.nan for kind in MET}
    return shares | {
        f"{kind}_peak": _largest(np.array([top for one, top in seen if one == kind])) for kind in MET
    }


def _kind(measures: Mapping[str, float], text: str) -> str:
    """What a simulated motion is, one of `MET`."""
    if text == "stuck":
        return "stuck"
    if text in MODULATED or modulation_of(measures):
        return "modulated"
    if measures.get("impacts_per_period", math.nan) == 0.0:
        return "calm"
    return "impacts"


MODULATED = ("chaotic", "quasi-periodic", "slow")


def recommend(
    study: Study | str | Path,
    *,
    cost: float = 0.05,
    target: float | None = None,
    workers: int | None = None,
    journal: Callable[[int], Path | None] = lambda _: None,
    tell: Callable[[str], None] = lambda _: None,
    progress: bool = False,
) -> Recommendation:
    """The value of what a study leaves open, its clearance, with which the worst response is lowest.

    1. Theory (`orbits.design.references.first_clearance`) gives a first value, and the range if the study has none.
    2. A diagram of the study's own machine at each of some values over the range.
    3. Diagrams of all samples between the neighbours of the best, twice; of a value that costs too much in one sample no others.
    4. Beside a jump of the response another value is taken, if it costs little enough.
    5. At the choice: what simulated starts lead to, loads, start-up, a sweep by simulation up and down.

    Of a machine whose flights are integrated 2. and 3. are simulations up and down and from drawn starts (`swept_responses`). Its choice
    is looked at by diagrams of all samples: it stands if these know no larger response, to 1 %.

    Parameters
    ----------
    study : Study or path
        `[survey] vary` has at most one parameter on a grid or a range with ``count``, which is chosen (``half_width`` if there is none); the others are
        uncertain.
    cost : float
        The share by which the worst response may be higher within the tolerance.
    target : float, optional
        The response that counts as quieted, in the study's unit; nine tenths of the bare machine's by default.
    workers : int, optional
        Processes; all cores by default.
    journal : callable, optional
        Round -> the file in which its rows are kept, so that interrupted work goes on.
    tell : callable, optional
        Takes a sentence at the beginning of each round.
    progress : bool

    Raises
    ------
    ValueError
        If nothing can be chosen; the sentence names the field and a way out.
    """
    from contvines.command.study import read_study

    if not isinstance(study, Study):
        study = read_study(study)
    work = _Work(study, cost, workers, journal, tell, progress)
    best = work.first_look()
    for count in LATER:
        if best is not None:
            best = work.between_neighbours(best, count)
    rows, jumps = None, []
    if best is not None:
        best, jumps = work.away_from_jumps(work.passed_over(best))
        best, rows = work.at_choice(best)
    return work.recommendation(best, rows, jumps, target)


@dataclass
class _Work:
    """The machines of a recommendation, and what is asked of them."""

    study: Study
    cost: float
    workers: int | None
    journal: Callable[[int], Path | None]
    tell: Callable[[str], None]
    progress: bool

    def __post_init__(self) -> None:
        from contvines.coexistence.population import population_of
        from contvines.command.compose import check_shaken, machine
        from contvines.command.survey_study import machines_of, plan_and_machine, units_of

        study = self.study
        if study.sort is Sort.FLOW:
            raise ValueError(
                f"{study.path}: contvines recommend is for machines; contvines survey --best chooses of flows."
            )
        if "samples" not in study.survey.model_fields_set:
            survey = study.survey.model_copy(update={"samples": SAMPLES})
            self.study = study = dataclasses.replace(study, survey=survey)
        check_shaken(study, study.survey.vary)
        self.assumed: list[str] = []
        self.missed: list[str] = []  # what is not known as simulations missed it
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
        self.name = next(iter(axes), "half_width")
        names = list(model.amount_names)
        if not axes:
            if study.sort is not Sort.PHYSICAL or self.name not in names:
                raise ValueError(_what(study, names))
            model = model.given_by(self.name)
        self.model, self.family, self.units = model, machines_of(study, model), units_of(study, model)
        self.drawn = self.plan.samples
        self.samples = self.plan.shape[-1] if self.drawn else 1
        self.theory = self._theory()
        self.integrated = population_of(model, study.parameter, **study.loose).price > 1.0
        if self.integrated:
            self.assumed.append(
                f"responses elsewhere than at the choice are those of simulations up and down at {SWEPT} values and from drawn starts: "
                "a motion to which few starts lead is not among them"
            )
        self.pace: float | None = None  # seconds a machine
        self.round = self.surveys = 0
        self.rows: dict[float, _Looked] = {}  # by value, of all samples
        self.places: dict[float, Place] = {}  # ascending

    def _theory(self) -> FirstClearance | None:
        from orbits.design.references import first_clearance

        if self.name != "half_width" or "damping" not in self.model.parameter_names:
            return None
        return first_clearance(self.model, self.model.vector(self.study.loose))

    def own(self) -> float | None:
        """The study's own value of what is chosen."""
        known = getattr(self.model, "quantities", None) or self.study.parameters
        return float(known[self.name]) if self.name in known else None

    def range(self) -> list[float]:
        """The values of the first look, the study's own among them where it lies in the range."""
        if self.plan.axes:
            given = self.plan.axes[self.name]
            low, high = float(given.min()), float(given.max())
            values = given.tolist() if len(given) >= LATER[1] else np.linspace(low, high, PLACES).tolist()
        else:
            if self.theory is None:
                raise ValueError(
                    f"{self.study.path}: [survey] gives no range of {self.name}, and theory none for this machine; for example "
                    f'vary.{self.name} = {{ within = ["5 mm", "50 mm"], count = {PLACES} }}.'
                )
            low, high = (share * self.theory.widest for share in SPREAD)
            values = np.geomspace(low, high, PLACES).tolist()
            unit = self.units.get(self.name, "")
            self.assumed.append(
                f"[survey] gives no range of {self.name.replace('_', ' ')}: looked at from {low:.3g} to {high:.3g} {unit}".rstrip()
                + f", {SPREAD[0]:g} to {SPREAD[1]:g} times the widest by theory"
            )
        own = self.own()
        if own is not None and self.plan.axes and not low <= own <= high:
            own = None
        return sorted({*map(_tidy, values), *([] if own is None else [own])})

    def best(self) -> Place | None:
        """The place with the lowest worst response of all samples; None where none is known."""
        return _best(place for place in self.places.values() if place.samples == self.samples)

    def note(self, places: Iterable[Place]) -> None:
        """Take up places, those of more samples instead of those of the first look."""
        self.places = dict(sorted((self.places | {place.value: place for place in places}).items()))

    def first_look(self) -> Place | None:
        """Diagrams of the study's own machine over the range; the best place."""

        values = self.range()
        self._tell_round(len(values))
        found = self._looked(Plan({self.name: np.array(values)}, {}))
        rows = dict(zip(values, (_Looked(*row) for row in zip(*(c.reshape(-1, 1) for c in found)))))
        if not self.drawn:
            self.rows |= rows
        self.note(_place(value, row, 1) for value, row in rows.items())
        return _best(self.places.values())

    def between_neighbours(self, best: Place, count: int) -> Place | None:
        """Diagrams of the samples at so many values between the neighbours of the best; the best then."""
        values = list(self.places)
        at = values.index(best.value)
        low, high = values[max(at - 1, 0)], values[min(at + 1, len(values) - 1)]
        self.later_look(map(_tidy, np.linspace(low, high, count)), best.value)
        return self.best()

    def later_look(self, values: Iterable[float], near: float) -> None:
        """Diagrams of the samples: all of them at the value nearest to the best; at others first of the sample that is worst there, and no more
        where that costs too much, for the worst of all samples is no better.
        """
        known = self.rows
        new = sorted((v for v in values if v not in known), key=lambda v: (abs(v - near), v))
        every = np.arange(self.samples)
        full = [v for v in known if not np.isnan(known[v].known).any()]
        self._tell_round(len(new) * self.samples, "at most " if self.samples > 1 else "")
        if not full and new:
            self._look(new[:1], every)
            full = [v for v in new[:1] if np.isfinite(known[v].known).all()]
        new = [v for v in new if v not in known]
        best = min(full, key=lambda v: known[v].known.max(), default=None)
        worst = every[:1] if best is None else every[[int(np.argmax(known[best].known))]]
        limit = math.inf if best is None else (1.0 + self.cost) * float(known[best].known.max())
        self._look(new, worst)
        self._look([v for v in new if known[v].known[worst[0]] <= limit], np.setdiff1d(every, worst))
        self.note(_place(value, row, self.samples) for value, row in known.items())

    def passed_over(self, best: Place) -> Place:
        """The best place: values at which the study's own machine has a much lower response than the best has in its worst sample
        are looked at in all samples, the lowest first, and then between their neighbours.
        """
        while True:
            alone = _best(place for place in self.places.values() if place.value not in self.rows)
            if alone is None or alone.worst >= (1.0 - self.cost) * best.worst:
                return best
            self.later_look([alone.value], alone.value)
            found = self.best()
            if found is not None and found.worst < best.worst:
                best = self.between_neighbours(found, LATER[-1]) or found

    def _look(self, values: Sequence[float], samples: np.ndarray) -> None:
        """Diagrams at these values, of these samples."""

        if not len(values) or not len(samples):
            return
        drawn = {name: column[samples] for name, column in self.drawn.items()}
        found = self._looked(Plan({self.name: np.array(values)}, drawn))
        for i, value in enumerate(values):
            nothing = (
                np.full(self.samples, np.nan),
                np.full(self.samples, np.nan),
                np.full(self.samples, UNSEEN, object),
            )
            row = self.rows.setdefault(value, _Looked(*nothing))
            for own, column in zip(row, found):
                own[samples] = column[i]

    def _looked(self, plan: Plan) -> _Looked:
        """Responses by diagrams, or by simulation where flights are integrated."""
        return _looked(self.surveyed(plan, RESPONSES, swept=SWEPT if self.integrated else 0))

    def _tell_round(self, machines: int, at_most: str = "") -> None:
        self.round += 1
        rest = "" if self.pace is None else f", about {_duration(self.pace * machines)}"
        said = f"{machines} {'machine' if machines == 1 else 'machines'}"
        self.tell(f"round {self.round} of {max(self.round, len(LATER) + 2)}: {at_most}{said}{rest}")

    def surveyed(self, plan: Plan, outcomes: Sequence[Any], **ways: Any) -> Survey:
        """The rows of a plan, kept in the journal of the round."""
        from contvines.command.surveying import without_main
        from contvines.survey.survey import survey

        self.surveys += 1
        begun = monotonic()
        options = {**options_of(self.study), "depth": 0}  # what leaves a branch is met by simulation, too
        with without_main():
            found = survey(
                self.family, plan, over=self.study.parameter, within=self.study.within, outcomes=outcomes, workers=self.workers,
                journal=self.journal(self.surveys), units=self.units, about={"recommend": self.surveys, "ways": list(ways), **asked_of(self.study)},
                progress=self.progress, gaps=self.study.survey.gaps, **ways, **options,
            )  # fmt: skip
        self.pace = (monotonic() - begun) / len(plan)
        return found

    # ------------------------------------------------------------------ at the choice
    def away_from_jumps(self, best: Place) -> tuple[Place, list[Jump]]:
        """The best place, and where the response jumps beside the choice.

        A rise next to the tolerance is looked at ever nearer, in the sample in which it rises most: a jump is what does not get smaller, or is near enough all the same. A choice within
        `MARGIN` of it gives way to the value that is as far, if that costs no more than the tolerance.
        """
        jumps, wanted = [], best.value
        for side in (-1, 1):
            jump = self._jump(best, side)
            if jump is not None:
                jumps.append(jump)
                kept_off = jump.at * (1.0 - side * MARGIN)
                wanted = max(wanted, kept_off) if side < 0 else min(wanted, kept_off)
        low, high = self.tolerance(best)
        wanted = _tidy(min(max(wanted, low), high))
        if wanted == best.value:
            return best, jumps
        self._look([wanted], np.arange(self.samples))
        other = _place(wanted, self.rows[wanted], self.samples)
        self.note([other])
        return other if other.worst <= (1.0 + self.cost) * best.worst else best, jumps

    def tolerance(self, best: Place) -> tuple[float, float]:
        """The farthest values about the best, without a gap, at which the worst response costs at most so much; of places with all samples, and
        those with a sample that costs more.
        """
        places = [place for place in self.places.values() if place.samples == best.samples]
        at = [place.value for place in places].index(best.value)
        costly = [not p.worst <= (1.0 + self.cost) * best.worst for p in places]
        low = max((i + 1 for i in range(at) if costly[i]), default=0)
        high = next((i - 1 for i in range(at + 1, len(places)) if costly[i]), len(places) - 1)
        return places[low].value, places[high].value

    def _jump(self, best: Place, side: int) -> Jump | None:
        """The jump next to the tolerance below (-1) or above (1) the best, or a rise as large near by; None where there is neither."""
        known = [p for p in self.places.values() if p.samples == best.samples and math.isfinite(p.worst)]
        good = self.places[self.tolerance(best)[side > 0]]
        end = known.index(good) + side
        if not 0 <= end < len(known) or (bad := known[end]).worst < (1.0 + JUMP) * best.worst:
            return None
        sample = [int(np.nanargmax(self.rows[bad.value].known))]
        inner, outer = (float(self.rows[v].known[sample[0]]) for v in (good.value, bad.value))
        near, far, rise = good.value, bad.value, outer - inner
        for _ in range(HALVED):
            middle = _tidy(0.5 * (near + far))
            if middle in (near, far):
                break
            self._look([middle], np.array(sample))
            response = float(self.rows[middle].known[sample[0]])
            if not math.isfinite(response):
                return None
            if outer - response < 0.5 * rise:
                far, outer = middle, response
            else:
                near, inner = middle, response
            rise = outer - inner
        if rise > JUMP * best.worst:
            return Jump(far, bad.value, bad.worst)
        steep = abs(bad.value - best.value) <= STEEP * abs(best.value)
        return Jump(bad.value, bad.value, bad.worst) if steep else None

    def at_choice(self, best: Place) -> tuple[Place | None, Survey | None]:
        """Diagrams of all samples at the choice, with simulated starts: the choice, its rows.

        Where places were simulated alone and the diagrams know a larger response, another one may be the best, which is looked at in its turn.
        """

        seen: dict[float, Survey] = {}
        choice: Place | None = best
        starts = FEW if self.integrated else STARTS
        while choice is not None and choice.value not in seen and len(seen) < TRIED:
            plan = Plan({self.name: np.array([choice.value])}, self.drawn)
            self.pace = self.pace if not self.integrated else None
            self._tell_round(len(plan))
            asked = ("peak", "lower_peak", "modulated", loads, met)
            rows = seen[choice.value] = self.surveyed(plan, asked, values=VALUES, starts=starts)
            if not self.integrated:
                break
            row = self.rows[choice.value] = _Looked(*(column.ravel() for column in _looked(rows)))
            exact = _place(choice.value, row, self.samples)
            self.note([exact])
            if exact.worst <= (1.0 + AGREES) * choice.worst:
                choice = exact
                break
            if math.isfinite(exact.worst):
                self.missed.append(
                    f"whether other values than {figures(choice.value)} have larger responses: there simulations up and down missed one "
                    f"({figures(choice.worst)}, by diagrams {figures(exact.worst)})"
                )
            choice = self.best()
            if choice is not None:
                choice = self.passed_over(choice)
        if choice is not None and choice.value not in seen:
            choice = _best(place for place in self.places.values() if place.value in seen)
        return choice, None if choice is None else seen[choice.value]

    def recommendation(
        self, best: Place | None, rows: Survey | None, jumps: list[Jump], target: float | None
    ) -> Recommendation:
        """All that is printed of the choice."""
        from contvines.command.compare import peaks_compared

        study = self.study
        unknown = [
            f"the response at {self.name.replace('_', ' ')} = {figures(place.value)} {self.units.get(self.name, '')}".rstrip()
            + (f" of {place.unknown} of {place.samples} samples" if place.samples > 1 else "")
            + (f" ({place.why})" if place.why else "")
            for place in self.places.values()
            if place.unknown
        ]
        unknown += self.missed
        has_bare = self.model.in_cavity and "damping" in self.model.parameter_names
        model, loose = self.family.machine_at({} if best is None else {self.name: best.value})
        compared = peaks_compared(model, study.parameter, study.within, KINDS) if has_bare else {}
        if not has_bare:
            unknown.append(
                "the response of a bare, a tuned and a friction-damped machine, start-up: they are available for the machine 'coupled' alone"
            )
        bare = compared.get("bare", (math.nan, 0.0))[0]
        goal = QUIETED * bare if target is None else target
        given = {
            "study": str(study.path), "title": study.path.stem, "name": self.name, "parameter": study.parameter,
            "within": study.within, "units": {**self.units, "time": "s" if self.model.units else ""},
            "own": self.own(), "cost": self.cost, "theory": {} if self.theory is None else dataclasses.asdict(self.theory),
            "machine": self._machine(), "places": list(self.places.values()), "compared": compared, "target": goal, "assumed": self.assumed, "unknown": unknown,
            "absorber": self.model.in_cavity,
        }  # fmt: skip
        if best is None or rows is None:
            return Recommendation(
                **given, value=None, tolerance=(math.nan, math.nan), works=math.nan, met={}, loads={}, checked=None, start_up=None,
            )  # fmt: skip
        peaks = rows.known("peak").ravel()
        works = float(np.mean(peaks <= goal)) if math.isfinite(goal) else math.nan
        shares = {name: float(np.nanmean(rows[f"met_{name}"])) for name in MET}
        tops = {
            name: _largest(rows[name])
            for name in (*(f"{kind}_peak" for kind in MET), *BAND, "modulated_strong")
        }
        shares |= {name: top for name, top in tops.items() if math.isfinite(top)}
        has = flow_of(self.model).measure_names(self.model)
        most = {name: _largest(rows[name]) for name in LOADS if name in has}
        if not most:
            unknown.append("loads: a declared machine has them for walls, with energy=")
        unknown += [
            f"{name}: no motion that was met has it" for name, value in most.items() if math.isnan(value)
        ]
        checked, curves = self._checked(best.value, model, loose)
        if checked is not None and abs(checked[1] - checked[0]) > AGREES * checked[0]:
            unknown.insert(
                0, f"the largest response at the choice: {figures(checked[0])} by the diagram, {figures(checked[1])} by simulation"
            )  # fmt: skip
        return Recommendation(
            **given, value=best.value, tolerance=self.tolerance(best), works=works, met=shares,
            loads={k: v for k, v in most.items() if math.isfinite(v)}, checked=checked, jumps=jumps,
            start_up=self._start_up(model, compared["bare"][1]) if has_bare else None, curves=curves + (self._lines(model) if has_bare else []),
        )  # fmt: skip

    def _machine(self) -> dict[str, str]:
        """The study's numbers as text, with what is uncertain."""
        known = getattr(self.model, "quantities", None) or self.study.parameters
        found = {
            name: f"{figures(value)} {self.model.units.get(name, '')}".rstrip()
            for name, value in known.items()
        }
        found.pop(self.study.parameter, None)
        for name, values in self.drawn.items():
            unit = self.model.units.get(name, "")
            found[name] = (
                f"{figures(values.min())} to {figures(values.max())} {unit}".rstrip()
                + f" in {len(values)} samples"
            )
        if self.name in found:
            found[self.name] = f"chosen; {found[self.name]} in the study"
        return found

    def _checked(
        self, value: float, model: Varying, own: dict[str, float]
    ) -> tuple[tuple[float, float] | None, list[Curve]]:
        """The largest response of the study's own machine at the choice, by its diagram and by simulation from that motion (at a value where it
        is next to the largest); of simulations up and down, if these meet more. The responses."""
        from contvines.graph.stretches import highest, inside, stretches
        from contvines.survey.outcomes import peak
        from contvines.survey.work import Job, work
        from orbits.attractors.search import beginning_with
        from orbits.attractors.sweeping import sweep
        from orbits.orbit import Orbit

        over, (low, high) = self.study.parameter, self.study.within
        seen: list[Curve] = []
        compared: list[tuple[float, float]] = []
        measure = flow_of(model).default_measure(model)
        loose: dict[str, Any] = {k: v for k, v in own.items() if k != over}

        def response_of(one: Unbranched) -> float:
            value = one.measures.get(measure, math.nan)
            return value if math.isfinite(value) else -math.inf

        def keep(found: Findings) -> dict[str, float]:
            parts = stretches(found.graph)
            seen.extend(Curve("stable", part.values.tolist(), part.response.tolist()) for part in parts)
            top = highest(parts)
            if top is not None:  # from itself: other starts may miss a motion that few of them lead to
                u, p, response = inside(top, 0.5 * AGREES)
                orbit = top.stretch.branch.attached.orbit(u, p)
                assert isinstance(orbit, Orbit)
                met = beginning_with(orbit, REPLAYED, LONGEST)
                compared.append((response, met.get(measure, -math.inf)))
            free = max(found.unbranched, key=response_of, default=None)
            if (
                free is not None
                and free.state is not None
                and response_of(free) > (top.response if top else -math.inf)
            ):
                begin: dict[str, Any] = {
                    "start": free.state,
                    "transient": REPLAYED,
                    "nudge": 0.0,
                    "exponents": False,
                }
                (longer,) = sweep(model, over, [free.value], **begin, **loose)
                compared[:] = [(response_of(free), longer.measures[measure])]
            return peak(found)

        job = Job(self.family, over, (low, high), (keep,), options={**options_of(self.study), "depth": 0})
        row = work(job, 0, {self.name: value})
        if not row.columns:
            return None, seen
        step, top = (high - low) / (CHECK - 1), row.columns["peak_at"]
        near = np.linspace(
            max(low, top - ABOUT * step), min(high, top + ABOUT * step), ROUGH if self.integrated else FINE
        )
        grid = np.union1d(np.linspace(low, high, CHECK), near)
        for run in (grid, grid[::-1]):
            rows = sweep(model, over, run, nudge=0.0, **loose)
            seen.append(Curve("simulated", [r.value for r in rows], [r.measures[measure] for r in rows]))
        most = max(*seen[-2].y, *seen[-1].y)
        largest = row.columns["peak"]  # of motions without a branch, too
        if not compared or compared[0][0] < (1.0 - AGREES) * largest or most > (1.0 + AGREES) * largest:
            return (largest, most), seen
        return compared[0], seen

    def _lines(self, model: Varying) -> list[Curve]:
        """Responses of the machines to compare with; declared machines have none."""
        from contvines.command.compare import POINTS, response_of
        from orbits.machines.base import Model

        if not isinstance(model, Model):
            return []
        values = np.linspace(*self.study.within, POINTS)
        params = np.array([model.vector_at(self.study.parameter, float(x), self.study.loose) for x in values])
        return [Curve(kind, values.tolist(), response_of(kind, model, params).tolist()) for kind in KINDS]

    def _start_up(self, model: Varying, at: float) -> Start:
        from contvines.command.measured import Scales
        from orbits.design.transients import start_up

        params = model.vector_at(self.study.parameter, at, self.study.loose)
        scales = Scales(model, params)
        length, seconds = scales.factor("length"), scales.factor("time")
        seen = start_up(model, params)
        self.assumed.append(
            f"start-up from rest at {self.study.parameter} = {figures(at)} {self.units.get(self.study.parameter, '')}".rstrip()
            + ", where the bare machine moves most"
        )
        thin = slice(None, None, max(1, len(seen.times) // DRAWN))
        return Start(
            peak=float(np.abs(seen.oscillator).max()) * length,
            bare_peak=float(np.abs(seen.bare).max()) * length,
            settled=seen.settled * seconds,
            bare_settled=seen.bare_settled * seconds,
            fastest_impact=float(seen.impact_speeds.max(initial=0.0)) * scales.factor("velocity"),
            worst_relative=float(np.abs(seen.relative).max()) * length,
            series={
                "time": (seen.times[thin] * seconds).tolist(),
                "oscillator": (seen.oscillator[thin] * length).tolist(),
                "bare": (seen.bare[thin] * length).tolist(),
            },
        )


class _Looked(NamedTuple):
    """Of machines the largest response, and the largest if the lowest of those that coexist is met, no number where not known; why (`UNSEEN`: not looked at)."""

    known: np.ndarray
    engaged: np.ndarray
    notes: np.ndarray


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
    why = (
        f"vary.{name} without count is uncertain"
        if said
        else "[survey] vary needs one parameter with a range"
    )
    return f"{study.path}: what is to be chosen? {why}; for example vary.{name} = {{ within = {within}, count = {PLACES} }}."


def _looked(found: Survey) -> _Looked:
    return _Looked(found.known("peak"), found.known("lower_peak"), found.notes)


def _place(value: float, row: _Looked, samples: int) -> Place:
    seen = row.notes != UNSEEN
    known, all_ = row.known[seen], bool(seen.all())
    unknown = int(np.count_nonzero(~np.isfinite(known)))
    why = next((str(note) for note, peak in zip(row.notes[seen], known) if not math.isfinite(peak)), "")
    median = float(np.nanmedian(known)) if all_ and unknown < samples else math.nan
    return Place(value, float(known.max()), median, float(row.engaged.max()), unknown, samples, why, not all_)


def _best(places: Iterable[Place]) -> Place | None:
    """The place with the lowest worst response; None where none is known."""
    known = (place for place in places if math.isfinite(place.worst))
    return min(known, key=lambda place: place.worst, default=None)


def _tidy(value: float) -> float:
    """A value of four digits: nobody builds more."""
    return float(f"{value:.4g}")


def _largest(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else math.nan


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90.0 else f"{seconds / 60.0:.0f} minutes"


def digest(study: Study, cost: float, target: float | None) -> str:
    """What decides a recommendation."""
    vary, places = study.survey.vary, [PLACES, *LATER]
    return digest_of({"of": asked_of(study), "vary": vary, "cost": cost, "target": target, "places": places})
