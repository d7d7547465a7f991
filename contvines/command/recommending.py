"""A clearance for a study: by theory, by a first look over its range, then by diagrams of all samples ever nearer to the best."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orbits.design.references import KINDS
from orbits.flows import flow_of

from ..shared.files import digest_of
from ..shared.motions import BAND
from ..shared.numbers import figures
from ..survey.plan import Plan
from .choosing import PLACES, SWEPT, Machines, largest, loads, met
from .choosing import tidy as _tidy
from .recommendation import AGREES, LOADS, MET, Jump, Place, Recommendation
from .study_data import Study
from .survey_study import asked_of

if TYPE_CHECKING:
    from ..survey import Survey

UNSEEN = "not looked at"  # a note
LATER = (7, 5)  # values of the later looks, between the neighbours of the best
QUIETED = 0.9  # of the bare machine's response: a machine that is quieted less does not work
VALUES, STARTS = 9, 6  # of the parameter, and at each, from which it is told what is met at the choice
FEW = 2  # starts where flights are integrated
TRIED = 5  # choices of such machines that are looked at by diagrams, until one is the best of all
STEEP = 0.05  # of the value that is chosen: a rise within it counts as a jump
MARGIN = 0.02  # of the value that is chosen: nearer to a jump of the response another value is taken, if it costs no more than the tolerance
JUMP = 0.2  # of the response: such a rise beside the tolerance is looked at
HALVED = 4  # how often the distance to it is halved


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
    from .study import read_study

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


class _Work(Machines):
    """The search for the best of the machines."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.missed: list[str] = []  # what is not known as simulations missed it
        self.round = 0
        self.rows: dict[float, _Looked] = {}  # by value, of all samples
        self.places: dict[float, Place] = {}  # ascending

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
        return _looked(self.surveyed(plan, ("peak", "lower_peak"), swept=SWEPT if self.integrated else 0))

    def _tell_round(self, machines: int, at_most: str = "") -> None:
        self.round += 1
        rest = "" if self.pace is None else f", about {_duration(self.pace * machines)}"
        said = f"{machines} {'machine' if machines == 1 else 'machines'}"
        self.tell(f"round {self.round} of {max(self.round, len(LATER) + 2)}: {at_most}{said}{rest}")

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
        from .plot import peaks_compared

        study = self.study
        unknown = [
            f"the response at {self.name.replace('_', ' ')} = {figures(place.value)} {self.units.get(self.name, '')}".rstrip()
            + (f" of {place.unknown} of {place.samples} samples" if place.samples > 1 else "")
            + (f" ({place.why})" if place.why else "")
            for place in self.places.values()
            if place.unknown
        ]
        unknown += self.missed
        has_bare = self.model.in_cavity and self.damped
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
            "own": self.known.get(self.name), "cost": self.cost, "theory": {} if self.theory is None else dataclasses.asdict(self.theory),
            "machine": self.described(), "places": list(self.places.values()), "compared": compared, "target": goal, "assumed": self.assumed, "unknown": unknown,
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
            name: largest(rows[name])
            for name in (*(f"{kind}_peak" for kind in MET), *BAND, "modulated_strong")
        }
        shares |= {name: top for name, top in tops.items() if math.isfinite(top)}
        has = flow_of(self.model).measure_names(self.model)
        most = {name: largest(rows[name]) for name in LOADS if name in has}
        if not most:
            unknown.append("loads: a declared machine has them for walls, with energy=")
        unknown += [
            f"{name}: no motion that was met has it" for name, value in most.items() if math.isnan(value)
        ]
        checked, curves = self.checked(best.value, model, loose)
        if checked is not None and abs(checked[1] - checked[0]) > AGREES * checked[0]:
            unknown.insert(
                0, f"the largest response at the choice: {figures(checked[0])} by the diagram, {figures(checked[1])} by simulation"
            )  # fmt: skip
        return Recommendation(
            **given, value=best.value, tolerance=self.tolerance(best), works=works, met=shares,
            loads={k: v for k, v in most.items() if math.isfinite(v)}, checked=checked, jumps=jumps,
            start_up=self.start_up(model, compared["bare"][1]) if has_bare else None, curves=curves + (self.compared(model) if has_bare else []),
        )  # fmt: skip


class _Looked(NamedTuple):
    """Of machines the largest response, and the largest if the lowest of those that coexist is met, no number where not known; why (`UNSEEN`: not looked at)."""

    known: np.ndarray
    engaged: np.ndarray
    notes: np.ndarray


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


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90.0 else f"{seconds / 60.0:.0f} minutes"


def digest(study: Study, cost: float, target: float | None) -> str:
    """What decides a recommendation."""
    vary, places = study.survey.vary, [PLACES, *LATER]
    return digest_of({"of": asked_of(study), "vary": vary, "cost": cost, "target": target, "places": places})
