"""Choice of a clearance for a study: by theory, by a first round over its range, then by diagrams of all samples closer and closer to the best value."""

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
from .recommendation import AGREES, LOADS, MOTION_KINDS, Jump, Place, Recommendation
from .study_data import Study
from .survey_study import asked_of

if TYPE_CHECKING:
    from ..survey import Survey

NOT_COMPUTED = "not looked at"  # note of a sample that was not computed
LATER = (7, 5)  # number of values in each later round, between the neighbours of the best one
QUIETED = 0.9  # default target, relative to the bare machine's response
VALUES, STARTS = 9, 6  # number of parameter values, and of starts at each, that are simulated at the choice
FEW = 2  # number of these starts if flights are integrated
TRIED = 5  # largest number of choices of such machines that are checked by diagrams
STEEP = 0.05  # relative distance from the choice within which a rise of the response counts as a jump
# smallest relative distance of the choice from a jump; another value keeps it, if that costs no more than the tolerance
MARGIN = 0.02
JUMP = 0.2  # relative rise of the response next to the tolerance that may be a jump
HALVED = 4  # bisections of the distance to such a rise


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
    """Recommend the value of a study's free parameter, usually a clearance, with the lowest worst response.

    1. Theory (`orbits.design.references.first_clearance`) gives a first value, and the range if the study has none.
    2. First round: a diagram of the study's machine, without uncertainty, at each of some values over the range.
    3. Later rounds: diagrams of all samples between the neighbours of the best value, twice; a value that is too bad in one sample is not
       computed for the others.
    4. A choice next to a jump of the response is moved away from it, if that costs little enough.
    5. At the choice: the kinds of motions that simulated starts reach, loads, start-up, and simulations up and down.

    For a machine whose flights are integrated, steps 2 and 3 use simulations up and down and from drawn starts (`swept_responses`) instead
    of diagrams. Its choice is then checked by diagrams of all samples: they must not find a response larger by more than 1 %.

    Parameters
    ----------
    study : Study or path
        At most one parameter in `[survey] vary` is on a grid or has a range with ``count``; it is chosen (``half_width`` if there is
        none). The others are uncertain.
    cost : float
        Relative increase of the worst response that is allowed within the tolerance.
    target : float, optional
        The response below which the machine counts as quieted, in the study's unit; by default nine tenths of the bare machine's response.
    workers : int, optional
        Number of processes; by default one per core.
    journal : callable, optional
        Returns for the number of a round the file in which its rows are stored, from which interrupted work resumes.
    tell : callable, optional
        Called with a message at the beginning of each round.
    progress : bool
        Whether to show the progress of each round.

    Raises
    ------
    ValueError
        If nothing can be chosen; the message names the field and suggests a remedy.
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
    """The search for the best machine."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.missed: list[str] = []  # sentences about larger responses that simulations have missed
        self.round = 0
        self.rows: dict[float, _Responses] = {}  # responses of all samples, by value
        self.places: dict[float, Place] = {}  # by value, ascending

    def best(self) -> Place | None:
        """Return the place with the lowest worst response of all samples; None if none is known."""
        return _best(place for place in self.places.values() if place.samples == self.samples)

    def note(self, places: Iterable[Place]) -> None:
        """Add places; they replace those of the first round at the same values."""
        self.places = dict(sorted((self.places | {place.value: place for place in places}).items()))

    def first_look(self) -> Place | None:
        """Compute diagrams of the study's machine, without uncertainty, over the range; return the best place."""

        values = self.range()
        self._tell_round(len(values))
        found = self._computed(Plan({self.name: np.array(values)}, {}))
        rows = dict(zip(values, (_Responses(*row) for row in zip(*(c.reshape(-1, 1) for c in found)))))
        if not self.drawn:
            self.rows |= rows
        self.note(_place(value, row, 1) for value, row in rows.items())
        return _best(self.places.values())

    def between_neighbours(self, best: Place, count: int) -> Place | None:
        """Compute diagrams of the samples at `count` values between the neighbours of the best place; return the new best place."""
        values = list(self.places)
        at = values.index(best.value)
        low, high = values[max(at - 1, 0)], values[min(at + 1, len(values) - 1)]
        self.later_look(map(_tidy, np.linspace(low, high, count)), best.value)
        return self.best()

    def later_look(self, values: Iterable[float], near: float) -> None:
        """Compute diagrams of the samples at some values.

        At the value nearest to `near` all samples are computed. At the others, the sample that is worst at the best value comes first; if
        its response is too large, the other samples are left out, as the worst of all samples cannot be lower.
        """
        rows = self.rows
        new = sorted((v for v in values if v not in rows), key=lambda v: (abs(v - near), v))
        every = np.arange(self.samples)
        full = [v for v in rows if not np.isnan(rows[v].known).any()]
        self._tell_round(len(new) * self.samples, "at most " if self.samples > 1 else "")
        if not full and new:
            self._add_diagrams(new[:1], every)
            full = [v for v in new[:1] if np.isfinite(rows[v].known).all()]
        new = [v for v in new if v not in rows]
        best = min(full, key=lambda v: rows[v].known.max(), default=None)
        worst = every[:1] if best is None else every[[int(np.argmax(rows[best].known))]]
        limit = math.inf if best is None else (1.0 + self.cost) * float(rows[best].known.max())
        self._add_diagrams(new, worst)
        self._add_diagrams([v for v in new if rows[v].known[worst[0]] <= limit], np.setdiff1d(every, worst))
        self.note(_place(value, row, self.samples) for value, row in rows.items())

    def passed_over(self, best: Place) -> Place:
        """Return the best place after computing all samples at promising values that the rounds have passed over.

        These are values of the first round with a response much lower than the worst response of the best place. They are computed in
        the order of the response; if one is better, the values between its neighbours are computed, too.
        """
        while True:
            other = _best(place for place in self.places.values() if place.value not in self.rows)
            if other is None or other.worst >= (1.0 - self.cost) * best.worst:
                return best
            self.later_look([other.value], other.value)
            found = self.best()
            if found is not None and found.worst < best.worst:
                best = self.between_neighbours(found, LATER[-1]) or found

    def _add_diagrams(self, values: Sequence[float], samples: np.ndarray) -> None:
        """Compute diagrams of some samples (by index) at some values, and add them to `rows`."""

        if not len(values) or not len(samples):
            return
        drawn = {name: column[samples] for name, column in self.drawn.items()}
        found = self._computed(Plan({self.name: np.array(values)}, drawn))
        for i, value in enumerate(values):
            nothing = (
                np.full(self.samples, np.nan),
                np.full(self.samples, np.nan),
                np.full(self.samples, NOT_COMPUTED, object),
            )
            row = self.rows.setdefault(value, _Responses(*nothing))
            for own, column in zip(row, found):
                own[samples] = column[i]

    def _computed(self, plan: Plan) -> _Responses:
        """Compute the responses of a plan, by diagrams, or by simulation if flights are integrated."""
        return _responses_of(
            self.surveyed(plan, ("peak", "lower_peak"), swept=SWEPT if self.integrated else 0)
        )

    def _tell_round(self, machines: int, at_most: str = "") -> None:
        self.round += 1
        rest = "" if self.pace is None else f", about {_duration(self.pace * machines)}"
        text = f"{machines} {'machine' if machines == 1 else 'machines'}"
        self.tell(f"round {self.round} of {max(self.round, len(LATER) + 2)}: {at_most}{text}{rest}")

    # ------------------------------------------------------------------ at the choice
    def away_from_jumps(self, best: Place) -> tuple[Place, list[Jump]]:
        """Return the place of the choice, moved away from jumps of the response, and these jumps.

        A rise next to the tolerance is refined by bisection in the sample with the largest response. It is a jump if it does not get
        smaller, or if it is within `STEEP` of the choice. A choice within `MARGIN` of a jump is moved to that distance, if it costs no
        more than the tolerance.
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
        self._add_diagrams([wanted], np.arange(self.samples))
        other = _place(wanted, self.rows[wanted], self.samples)
        self.note([other])
        return other if other.worst <= (1.0 + self.cost) * best.worst else best, jumps

    def tolerance(self, best: Place) -> tuple[float, float]:
        """Return the interval of computed values around the best in which the worst response is at most `cost` higher.

        Only places with all samples, or with a sample that is too bad, are considered.
        """
        places = [place for place in self.places.values() if place.samples == best.samples]
        at = [place.value for place in places].index(best.value)
        costly = [not p.worst <= (1.0 + self.cost) * best.worst for p in places]
        low = max((i + 1 for i in range(at) if costly[i]), default=0)
        high = next((i - 1 for i in range(at + 1, len(places)) if costly[i]), len(places) - 1)
        return places[low].value, places[high].value

    def _jump(self, best: Place, side: int) -> Jump | None:
        """Return the jump next to the tolerance below (-1) or above (1) the best, or an equally large rise near it; None if there is neither."""
        complete = [p for p in self.places.values() if p.samples == best.samples and math.isfinite(p.worst)]
        good = self.places[self.tolerance(best)[side > 0]]
        end = complete.index(good) + side
        if not 0 <= end < len(complete) or (bad := complete[end]).worst < (1.0 + JUMP) * best.worst:
            return None
        sample = [int(np.nanargmax(self.rows[bad.value].known))]
        inner, outer = (float(self.rows[v].known[sample[0]]) for v in (good.value, bad.value))
        near, far, rise = good.value, bad.value, outer - inner
        for _ in range(HALVED):
            middle = _tidy(0.5 * (near + far))
            if middle in (near, far):
                break
            self._add_diagrams([middle], np.array(sample))
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
        """Compute diagrams of all samples, with simulated starts, at the choice; return the final choice and its survey.

        If the places come from simulation alone and the diagrams find a larger response, another place may be the best; it is then checked
        likewise.
        """

        surveys: dict[float, Survey] = {}
        choice: Place | None = best
        starts = FEW if self.integrated else STARTS
        while choice is not None and choice.value not in surveys and len(surveys) < TRIED:
            plan = Plan({self.name: np.array([choice.value])}, self.drawn)
            self.pace = self.pace if not self.integrated else None
            self._tell_round(len(plan))
            asked = ("peak", "lower_peak", "modulated", loads, met)
            rows = surveys[choice.value] = self.surveyed(plan, asked, values=VALUES, starts=starts)
            if not self.integrated:
                break
            row = self.rows[choice.value] = _Responses(*(column.ravel() for column in _responses_of(rows)))
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
        if choice is not None and choice.value not in surveys:
            choice = _best(place for place in self.places.values() if place.value in surveys)
        return choice, None if choice is None else surveys[choice.value]

    def recommendation(
        self, best: Place | None, rows: Survey | None, jumps: list[Jump], target: float | None
    ) -> Recommendation:
        """Collect all results about the choice."""
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
        shares = {name: float(np.nanmean(rows[f"met_{name}"])) for name in MOTION_KINDS}
        tops = {
            name: largest(rows[name])
            for name in (*(f"{kind}_peak" for kind in MOTION_KINDS), *BAND, "modulated_strong")
        }
        shares |= {name: top for name, top in tops.items() if math.isfinite(top)}
        names = flow_of(self.model).measure_names(self.model)
        most = {name: largest(rows[name]) for name in LOADS if name in names}
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


class _Responses(NamedTuple):
    """Responses of machines, as arrays.

    Fields: the largest response; the largest one if the lowest coexisting response always occurs (both nan if unknown); notes with the
    reasons (`NOT_COMPUTED` if not computed).
    """

    known: np.ndarray
    engaged: np.ndarray
    notes: np.ndarray


def _responses_of(found: Survey) -> _Responses:
    return _Responses(found.known("peak"), found.known("lower_peak"), found.notes)


def _place(value: float, row: _Responses, samples: int) -> Place:
    computed = row.notes != NOT_COMPUTED
    finite, all_ = row.known[computed], bool(computed.all())
    unknown = int(np.count_nonzero(~np.isfinite(finite)))
    reason = next(
        (str(note) for note, peak in zip(row.notes[computed], finite) if not math.isfinite(peak)), ""
    )
    median = float(np.nanmedian(finite)) if all_ and unknown < samples else math.nan
    return Place(
        value, float(finite.max()), median, float(row.engaged.max()), unknown, samples, reason, not all_
    )


def _best(places: Iterable[Place]) -> Place | None:
    """Return the place with the lowest worst response; None if none is known."""
    finite = (place for place in places if math.isfinite(place.worst))
    return min(finite, key=lambda place: place.worst, default=None)


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90.0 else f"{seconds / 60.0:.0f} minutes"


def digest(study: Study, cost: float, target: float | None) -> str:
    """Return the digest of everything that determines a recommendation."""
    vary, places = study.survey.vary, [PLACES, *LATER]
    return digest_of({"of": asked_of(study), "vary": vary, "cost": cost, "target": target, "places": places})
