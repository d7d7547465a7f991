"""What `contvines recommend` found: numbers, and the sentences and tables that tell them."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Annotated, Any

from pydantic import BeforeValidator, TypeAdapter

from ..shared.motions import BAND
from ..shared.numbers import figures
from ..text_table import Table, fitted, terminal_width

AGREES = 0.01  # of the largest response by diagrams: simulations that exceed it by more are told
MOST = 4  # sentences about what is not known
THOUSAND = 1000.0
LARGER = {"mm": "m", "mm/s": "m/s", "mJ": "J", "mW": "W", "mN": "N"}
"""Units in which a thousand and more of the unit are shown."""


MET = {
    "impacts": "impacts every period or nearly",
    "modulated": "modulated: impacts come and go",
    "calm": "calm: slides without impacts",
    "stuck": "stuck: moves with the oscillator",
}
"""What simulated motions are."""
PLAIN = {
    "impacts": "periodic, hits rigid walls",
    "modulated": "modulated",
    "calm": "periodic, hits no rigid wall",
    "stuck": "stuck",
}
"""The same of machines that are not known to have an absorber."""
LOADS = {
    "impact_speed": ("fastest impact", "of periodic and modulated motions"),
    "approach_speed": ("fastest impact", "of periodic motions"),
    "impulse": ("impulse of an impact", "largest; periodic motions"),
    "mean_force": ("mean impact force", "over a period"),
    "impact_rate": ("impacts per second", "noise: how often"),
    "impact_energy": ("energy of an impact", "noise: how hard"),
}
"""Measures that say what impacts do, and what is said of them."""
Number = Annotated[float, BeforeValidator(lambda value: math.nan if value is None else value)]
"""Not known where JSON has null."""


@dataclass(frozen=True)
class Place:
    """One value of what is chosen, over the samples.

    Attributes
    ----------
    value : float
    worst, median : float
        Of the largest response over all that coexists; no number where it is not known of every sample.
    engaged : float
        The worst if at each value of the parameter the lowest of the coexisting responses is met.
    unknown, samples : int
        Of how many samples the response is not known, and how many there are; one where nothing is uncertain, and in the first look.
    why : str
        Of the first one that is not known.
    left : bool
        Whether samples were left out, as the response in one of them is too large already: the worst is at least `worst`.
    """

    value: Number
    worst: Number
    median: Number
    engaged: Number
    unknown: int
    samples: int
    why: str = ""
    left: bool = False


@dataclass(frozen=True)
class Jump:
    """Where the worst response jumps beside the tolerance: it has done so at `at`, and is at least `response` at `beyond`, which is no nearer."""

    at: float
    beyond: float
    response: float


@dataclass(frozen=True)
class Curve:
    """A response over the parameter: `name` is ``stable``, ``simulated`` (up and down), or one of `orbits.design.references.KINDS`."""

    name: str
    x: list[float]
    y: list[float]


@dataclass(frozen=True)
class Start:
    """The start-up at the choice, in the study's units; see `orbits.design.transients.start_up`."""

    peak: Number
    bare_peak: Number
    settled: Number
    bare_settled: Number
    fastest_impact: Number
    worst_relative: Number
    series: dict[str, list[float]] = field(default_factory=dict, repr=False)


@dataclass(frozen=True)
class Recommendation:
    """A value, what it costs and brings, and what is not known.

    Attributes
    ----------
    study, title : str
    name, parameter : str
        What is chosen, and what the responses run over.
    within : (float, float)
        The parameter's interval.
    units : dict
        Of all names below.
    value : float or None
        The choice; None where nothing is known of any value with all samples.
    own : float or None
        What the study's `[model]` has.
    tolerance : (float, float)
        Between these values the worst response is at most `cost` above the best; they are values that were looked at, so that the true
        interval is wider.
    cost : float
        As a share.
    theory : dict
        `orbits.design.references.first_clearance`; empty where there is none.
    places : list of Place
        All that was looked at, ascending; those of the first look are of the study's own machine.
    compared : dict
        Kind -> largest response and where, of the machines to compare with.
    target : float
        The response at which the machine counts as quieted; `works` is the share of samples in which the worst response is at most this.
    works : float
    met : dict
        Shares of simulated starts (over samples, values, starts) by what they lead to: ``impacts``, ``modulated``, ``calm``, ``stuck``; the
        largest responses of each, ``calm_peak`` and so on; the band of modulated ones (`contvines.shared.motions`) and how many are strongly so.
    loads : dict
        Largest over the stable motions and samples, by measure.
    checked : (float, float) or None
        Largest response of the study's machine at the choice by the diagram and by simulation.
    start_up : Start or None
    jumps : list of Jump
        Next to the tolerance, below or above it.
    machine : dict
        The study's quantities by name, as text with units and with what is uncertain of them.
    curves : list of Curve
        Responses of the study's machine at the choice, and those to compare with.
    assumed, unknown : list of str
    absorber : bool
        Whether an absorber slides in a cavity of the machine, so that the words for it fit.
    """

    study: str
    title: str
    name: str
    parameter: str
    within: tuple[float, float]
    units: dict[str, str]
    value: float | None
    own: float | None
    tolerance: tuple[Number, Number]
    cost: Number
    theory: dict[str, float]
    places: list[Place]
    compared: dict[str, tuple[float, float]]
    target: Number
    works: Number
    met: dict[str, float]
    loads: dict[str, float]
    checked: tuple[float, float] | None
    start_up: Start | None
    machine: dict[str, str] = field(default_factory=dict)
    jumps: list[Jump] = field(default_factory=list)
    curves: list[Curve] = field(default_factory=list, repr=False)
    assumed: list[str] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    absorber: bool = True

    def to_dict(self) -> dict[str, Any]:
        """For JSON, at full precision."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Recommendation:
        """From `to_dict`, through JSON: that has no nan."""
        return TypeAdapter(cls).validate_python(data)

    # ------------------------------------------------------------------ sentences
    def shown(self, name: str, value: float | None) -> str:
        """A value with its unit, for people."""
        if value is None or not math.isfinite(value):
            return "not known"
        unit = self.units.get(name, "")
        larger = LARGER.get(unit)
        if larger is not None and abs(value) >= THOUSAND:
            value, unit = value / THOUSAND, larger
        return f"{figures(value)} {unit}".rstrip()

    @property
    def chosen(self) -> Place | None:
        """The place of the choice."""
        return next((p for p in self.places if p.value == self.value and p.samples == self.most), None)

    @property
    def most(self) -> int:
        """How many samples the later looks have."""
        return max(place.samples for place in self.places)

    @property
    def _named(self) -> str:
        """What is chosen, in words."""
        return self.name.replace("_", " ")

    @property
    def simulated(self) -> float:
        """Largest response at the choice by simulation where this is more than the worst that diagrams know; else minus infinity."""
        place = self.chosen
        if place is None or self.checked is None or self.checked[1] <= (1.0 + AGREES) * place.worst:
            return -math.inf
        return self.checked[1]

    @property
    def at_end(self) -> bool:
        """Whether the choice is the least or the largest value that was looked at."""
        values = [place.value for place in self.places]
        return len(values) > 1 and self.value in (min(values), max(values))

    @property
    def _kinds(self) -> dict[str, str]:
        """What simulated motions are, in words that fit the machine."""
        return MET if self.absorber else PLAIN

    @property
    def headline(self) -> str:
        """The answer in one sentence."""
        if self.value is None:
            return f"No {self._named} can be recommended: {self.unknown[0] if self.unknown else 'nothing is known'}."
        low, high = self.tolerance
        said = f"Recommended: {self._named} {self.shown(self.name, self.value)}"
        if self.at_end:
            said += ", at the end of the range that was looked at: a better one may lie beyond"
        if low < high:
            said += f"; from {low:.3g} to {self.shown(self.name, float(f'{high:.3g}'))} it costs less than {100 * self.cost:g} %"
        return said + "."

    @property
    def sentences(self) -> list[str]:
        """What there is to say beside the tables, the most important first."""
        peak, place, own = "peak", self.chosen, self._own()
        found = [*self._beside(), *([own] if own else [])]
        if place is not None and self.simulated > place.worst:
            found.insert(
                0, f"Simulation meets {self.shown(peak, self.simulated)} there, more than the diagrams know ({self.shown(peak, place.worst)}): the largest response is not known."
            )  # fmt: skip
        if self.theory:
            t = self.theory
            found.append(
                f"By theory (steady impacts, no friction): at most {self.shown(self.name, t['widest'])}, with {self.shown(peak, t['remaining'])} "
                f"left at resonance; from every start only below {self.shown(self.name, t['entered'])}, the linear peak."
            )
        if place is not None and "tuned" in self.compared:
            tuned = self.compared["tuned"][0]
            does, stays = (
                ("do better", " while it stays in tune") if tuned < place.worst else ("not do better", "")
            )
            found.append(f"A tuned absorber of the same mass would {does}: {self.shown(peak, tuned)}{stays}.")
        tops = {kind: self.met.get(f"{kind}_peak", -math.inf) for kind in MET}
        kind = max(tops, key=lambda kind: tops[kind])
        if tops["impacts"] > -math.inf and tops[kind] > tops["impacts"]:
            found.append(
                f"The largest response is that of a motion {'in which the absorber does not do its work' if self.absorber else 'of another kind'} "
                f"({self._kinds[kind]}): {self.shown(peak, tops[kind])}; "
                f"with impacts in every period it is at most {self.shown(peak, self.met['impacts_peak'])}."
            )
        engaged = self.engaged
        if place is not None and engaged is not None and engaged.engaged < (1.0 - self.cost) * place.worst:
            found.append(
                f"If {'the absorber is at work' if self.absorber else 'the motion with the lowest response is met'} at every {self.parameter} (the "
                f"lowest response of those that coexist), the best is about {self._named} = {self.shown(self.name, engaged.value)} with "
                f"{self.shown(peak, engaged.engaged)}; nothing makes sure that it is."
            )
        return found

    def _beside(self) -> list[str]:
        """How far from the choice the response jumps, and what the place with the lowest response has that stands nearer to it."""
        place, found = self.chosen, []
        if place is None:
            return []
        for jump in self.jumps:
            by, way = abs(jump.at - place.value), "lower" if jump.at < place.value else "higher"
            there = f"{self.shown('peak', jump.response)} at {self.shown(self.name, jump.beyond)}"
            found.append(f"{self.shown(self.name, by)} {way} it jumps: {there}.")
        lowest = min(
            (p for p in self.places if p.samples == place.samples and not p.left and math.isfinite(p.worst)),
            key=lambda p: p.worst,
        )
        nearer = any(abs(jump.at - lowest.value) < abs(jump.at - place.value) for jump in self.jumps)
        if nearer and lowest.worst < place.worst:
            found.append(
                f"The lowest response, {self.shown('peak', lowest.worst)} at {self.shown(self.name, lowest.value)}, stands nearer to the jump."
            )
        return found

    @property
    def engaged(self) -> Place | None:
        """The place with the lowest response if the lowest of those that coexist is met."""
        known = [place for place in self.places if math.isfinite(place.engaged)]
        return min(known, key=lambda place: place.engaged, default=None)

    def _own(self) -> str:
        """How the study's own value compares with the choice."""
        if self.own is None or self.value is None:
            return ""
        place = next((place for place in self.places if place.value == self.own), None)
        if self.tolerance[0] <= self.own <= self.tolerance[1]:
            return f"The study's own {self.shown(self.name, self.own)} is as good."
        chosen = self.chosen
        if place is not None and chosen is not None and place.worst < chosen.worst:
            return f"Whether the study's {self.shown(self.name, self.own)} is better is not known: {self.shown('peak', place.worst)}, not of all samples or not by diagrams."
        ratio = self.value / self.own
        factor = max(ratio, 1.0 / ratio)
        share = f"{100.0 * abs(self.own / self.value - 1.0):.2g} %"
        by = f"about {round(factor)} times" if factor >= 1.5 else share
        worst = ""
        if place is not None and math.isfinite(place.worst):
            worst = f": {self.shown('peak', place.worst)} at worst"
        return f"The study's {self.shown(self.name, self.own)} is {by} too {'small' if ratio > 1.0 else 'large'}{worst}."

    @property
    def rows(self) -> list[tuple[str, str, str]]:
        """The table of responses: what, how much, remark."""
        from orbits.design.references import NAMES

        place, found = self.chosen, []
        if place is not None:
            over = f"worst of {place.samples} samples" if place.samples > 1 else "worst of all that coexists"
            met = self.simulated > place.worst
            if met:
                found.append(
                    ("recommended", f"at least {self.shown('peak', self.simulated)}", "by simulation")
                )
            found.append(("by diagrams" if met else "recommended", self.shown("peak", place.worst), over))
            if place.samples > 1:
                found.append(("recommended, median", self.shown("peak", place.median), ""))
            name = "absorber at work" if self.absorber else "lowest motion"
            lowest = "lowest of what coexists, worst of the samples"
            found.append((name, self.shown("peak", place.engaged), lowest))
        for kind, (value, at) in self.compared.items():
            found.append((NAMES[kind], self.shown("peak", value), f"at {self.shown(self.parameter, at)}"))
        return found

    @property
    def behaviour(self) -> list[tuple[str, str, str]]:
        """Where it works, and what happens else."""
        said = "not known" if math.isnan(self.works) else f"{100 * self.works:.3g} %"
        found = []
        if not math.isnan(self.target):
            most = self.shown("peak", self.target)
            found.append(("works", said, f"of the samples: at most {most} whatever coexists"))
        for kind, name in self._kinds.items():
            share, top = self.met.get(kind, math.nan), self.met.get(f"{kind}_peak", math.nan)
            if math.isnan(share):
                continue
            told = "of simulated starts" if share > 0.0 or math.isfinite(top) else "not met"
            told += f"; at most {self.shown('peak', top)}" if math.isfinite(top) else ""
            if kind == "modulated" and BAND[1] in self.met:
                low, mean, high = (self.shown("peak", self.met[end]) for end in BAND)
                told += f", per period {low} to {high} (mean {mean}); {100 * self.met['modulated_strong']:.3g} % of them strongly"
            found.append((f"  {name}", f"{100 * share:.3g} %", told))
        return found

    @property
    def load_rows(self) -> list[tuple[str, str, str]]:
        """Loads and noise."""
        return [
            (said, self.shown(name, self.loads[name]), why)
            for name, (said, why) in LOADS.items()
            if name in self.loads
        ]

    @property
    def start_rows(self) -> list[tuple[str, str, str]]:
        """The start-up."""
        start = self.start_up
        if start is None:
            return []

        def settled(seconds: float) -> str:
            return self.shown("time", seconds) if math.isfinite(seconds) else "does not"

        peak, bare = self.shown("peak", start.peak), self.shown("peak", start.bare_peak)
        return [
            ("largest displacement", peak, f"bare: {bare}"),
            ("settles after", settled(start.settled), f"bare: {settled(start.bare_settled)}"),
            ("fastest impact", self.shown("impact_speed", start.fastest_impact), ""),
            ("largest relative displacement", self.shown("peak", start.worst_relative), ""),
        ]

    @property
    def first_unknown(self) -> list[str]:
        """The first sentences on what is not known, and how many more there are."""
        more = len(self.unknown) - MOST
        return [*self.unknown[:MOST], *([f"{more} more, in the JSON"] if more > 0 else [])]

    @property
    def start_up_at(self) -> str:
        """Under which excitation it is."""
        said = next((text for text in self.assumed if text.startswith("start-up")), "")
        return said.partition(" from rest ")[2]

    @property
    def tables(self) -> list[tuple[str, list[tuple[str, str, str]]]]:
        """All tables with their titles; those that have rows."""
        low, high = self.within
        over = f"Largest response, {self.parameter} {figures(low)} to {self.shown(self.parameter, high)}"
        at = "" if self.value is None else f" At {self._named} = {self.shown(self.name, self.value)}"
        found = [
            (over, self.rows),
            (f"Does it work?{at}", self.behaviour if self.met or self.value is not None else []),
            ("Loads and noise, worst of the samples", self.load_rows),
            ("Start-up from rest", self.start_rows),
        ]
        return [(title, rows) for title, rows in found if rows]

    def __str__(self) -> str:
        width = terminal_width()
        lines = [fitted(f"{self.title}: {self.headline}"), *map(fitted, self.sentences)]
        for title, rows in self.tables:
            lines += ["", title, *Table(("", "value", ""), [*rows], (), ()).lines(width)[1:]]
        if self.checked is not None:
            by, simulated = (self.shown("peak", value) for value in self.checked)
            checked = (
                f"Checked by simulation at the largest response: {simulated}, beside {by} of the diagram."
            )
            lines += ["", fitted(checked)]
        for head, said in (("assumed", self.assumed), ("not known", self.first_unknown)):
            lines += [fitted(f"{head}: {sentence}") for sentence in said]
        return "\n".join(lines)
