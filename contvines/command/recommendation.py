"""The result of `contvines recommend`: its data, and the sentences and tables that present them."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Annotated, Any

from pydantic import BeforeValidator, TypeAdapter

from ..shared.motions import BAND
from ..shared.numbers import figures
from ..text_table import Table, fitted, terminal_width

AGREES = 0.01  # relative excess of simulated responses over those of diagrams above which it is reported
MOST = 4  # largest number of sentences about unknown results
THOUSAND = 1000.0
LARGER = {"mm": "m", "mm/s": "m/s", "mJ": "J", "mW": "W", "mN": "N"}
"""Larger unit in which numbers of a thousand and more are shown, by unit."""


MOTION_KINDS = {
    "impacts": "impacts every period or nearly",
    "modulated": "modulated: impacts come and go",
    "calm": "calm: slides without impacts",
    "stuck": "stuck: moves with the oscillator",
}
"""Kinds of simulated motions of machines with an absorber, with their descriptions."""
PLAIN = {
    "impacts": "periodic, hits rigid walls",
    "modulated": "modulated",
    "calm": "periodic, hits no rigid wall",
    "stuck": "stuck",
}
"""Descriptions of the kinds for other machines."""
LOADS = {
    "impact_speed": ("fastest impact", "of periodic and modulated motions"),
    "approach_speed": ("fastest impact", "of periodic motions"),
    "impulse": ("impulse of an impact", "largest; periodic motions"),
    "peak_force": ("peak impact force", "half a sine over contact_time; periodic motions"),
    "mean_force": ("mean impact force", "over a period"),
    "impact_rate": ("impacts per second", "noise: how often"),
    "impact_energy": ("energy of an impact", "noise: how hard"),
}
"""Measures of loads and noise by impacts, with name and remark for the table."""
Number = Annotated[float, BeforeValidator(lambda value: math.nan if value is None else value)]
"""A number that is nan where JSON has null: unknown."""


@dataclass(frozen=True)
class Place:
    """Responses at one value of the chosen parameter, over all samples of the uncertain parameters.

    Attributes
    ----------
    value : float
        Of the chosen parameter.
    worst, median : float
        Over the samples, of the largest response of all coexisting motions; nan if it is not known for every sample.
    engaged : float
        The worst response if at each value of the parameter the lowest coexisting response occurs.
    unknown, samples : int
        Number of samples with unknown response, and of all samples; 1 without uncertain parameters, and in the first round.
    why : str
        Reason for the first unknown response.
    left : bool
        Whether samples were left out because one response was too large already; the true worst response is then at least `worst`.
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
    """A jump of the worst response just outside the tolerance.

    Attributes
    ----------
    at : float
        Nearest value of the chosen parameter beyond the jump.
    beyond, response : float
        A value at `at` or further away, and the worst response there.
    """

    at: float
    beyond: float
    response: float


@dataclass(frozen=True)
class Curve:
    """A response curve over the parameter: `name` is ``stable``, ``simulated`` (up and down), or one of `orbits.design.references.KINDS`."""

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
    """A recommended value of a parameter, with its benefits, its costs, and the gaps in the results.

    Attributes
    ----------
    study, title : str
        Path and name of the study.
    name, parameter : str
        The chosen parameter, and the parameter over which responses are computed.
    within : (float, float)
        Interval of `parameter`.
    units : dict
        Units of the names below.
    value : float or None
        The choice; None if no value has known responses for all samples.
    own : float or None
        The value in the study's `[model]`.
    tolerance : (float, float)
        Interval in which the worst response is at most `cost` above the best. Its ends are computed values; the true interval is wider.
    cost : float
        Relative.
    theory : dict
        Result of `orbits.design.references.first_clearance`; empty if there is none.
    places : list of Place
        All computed values, ascending; those of the first round are for the study's machine without uncertainty.
    compared : dict
        Largest response and its place, by kind of machine for comparison.
    target : float
        The response below which the machine counts as quieted.
    works : float
        Share of samples whose worst response is at most `target`.
    met : dict
        Shares of simulated starts (over samples, values, starts) by the kind of motion reached: ``impacts``, ``modulated``, ``calm``,
        ``stuck``; the largest response of each kind, ``calm_peak`` and so on; the band of modulated motions (`contvines.shared.motions`)
        and the share of strong modulation among them.
    loads : dict
        Largest value over the stable motions and samples, by measure.
    checked : (float, float) or None
        Largest response of the study's machine at the choice, by the diagram and by simulation.
    start_up : Start or None
    jumps : list of Jump
        Next to the tolerance, below or above it.
    machine : dict
        The study's quantities by name, as text with units and uncertainties.
    curves : list of Curve
        Responses of the study's machine at the choice, and of the machines for comparison.
    assumed, unknown : list of str
        Sentences about assumptions and unknown results.
    absorber : bool
        Whether the machine has an absorber in a cavity, so that the descriptions in `MOTION_KINDS` apply.
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
        """Return the data ready for JSON, at full precision."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Recommendation:
        """Make a recommendation from the JSON data of `to_dict`, with null for nan."""
        return TypeAdapter(cls).validate_python(data)

    # ------------------------------------------------------------------ sentences
    def shown(self, name: str, value: float | None) -> str:
        """Format a value with its unit."""
        if value is None or not math.isfinite(value):
            return "not known"
        unit = self.units.get(name, "")
        larger = LARGER.get(unit)
        if larger is not None and abs(value) >= THOUSAND:
            value, unit = value / THOUSAND, larger
        return f"{figures(value)} {unit}".rstrip()

    @property
    def chosen(self) -> Place | None:
        """The entry of `places` for the choice."""
        return next((p for p in self.places if p.value == self.value and p.samples == self.most), None)

    @property
    def most(self) -> int:
        """Number of samples in the later rounds."""
        return max(place.samples for place in self.places)

    @property
    def _named(self) -> str:
        """The chosen parameter, in words."""
        return self.name.replace("_", " ")

    @property
    def simulated(self) -> float:
        """Largest simulated response at the choice if it exceeds the worst response of diagrams; otherwise minus infinity."""
        place = self.chosen
        if place is None or self.checked is None or self.checked[1] <= (1.0 + AGREES) * place.worst:
            return -math.inf
        return self.checked[1]

    @property
    def at_end(self) -> bool:
        """Whether the choice is the smallest or the largest computed value."""
        values = [place.value for place in self.places]
        return len(values) > 1 and self.value in (min(values), max(values))

    @property
    def _kinds(self) -> dict[str, str]:
        """Descriptions of the kinds of simulated motions that apply to the machine."""
        return MOTION_KINDS if self.absorber else PLAIN

    @property
    def headline(self) -> str:
        """The answer in one sentence."""
        if self.value is None:
            return f"No {self._named} can be recommended: {self.unknown[0] if self.unknown else 'nothing is known'}."
        low, high = self.tolerance
        text = f"Recommended: {self._named} {self.shown(self.name, self.value)}"
        if self.at_end:
            text += ", at the end of the range that was looked at: a better one may lie beyond"
        if low < high:
            text += f"; from {low:.3g} to {self.shown(self.name, float(f'{high:.3g}'))} it costs less than {100 * self.cost:g} %"
        return text + "."

    @property
    def sentences(self) -> list[str]:
        """Return the sentences beside the tables, the most important first."""
        peak, place, own = "peak", self.chosen, self._own()
        found = [*self._near_jumps(), *([own] if own else [])]
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
            verb, stays = (
                ("do better", " while it stays in tune") if tuned < place.worst else ("not do better", "")
            )
            found.append(f"A tuned absorber of the same mass would {verb}: {self.shown(peak, tuned)}{stays}.")
        tops = {kind: self.met.get(f"{kind}_peak", -math.inf) for kind in MOTION_KINDS}
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

    def _near_jumps(self) -> list[str]:
        """Return sentences about the distance of the choice from jumps, and about a lower response nearer to a jump."""
        place, found = self.chosen, []
        if place is None:
            return []
        for jump in self.jumps:
            distance, side = abs(jump.at - place.value), "lower" if jump.at < place.value else "higher"
            response = f"{self.shown('peak', jump.response)} at {self.shown(self.name, jump.beyond)}"
            found.append(f"{self.shown(self.name, distance)} {side} it jumps: {response}.")
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
        """The entry of `places` with the lowest response if the lowest coexisting response always occurs."""
        finite = [place for place in self.places if math.isfinite(place.engaged)]
        return min(finite, key=lambda place: place.engaged, default=None)

    def _own(self) -> str:
        """Compare the study's own value with the choice in a sentence."""
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
        ratio_text = f"about {round(factor)} times" if factor >= 1.5 else share
        worst = ""
        if place is not None and math.isfinite(place.worst):
            worst = f": {self.shown('peak', place.worst)} at worst"
        return f"The study's {self.shown(self.name, self.own)} is {ratio_text} too {'small' if ratio > 1.0 else 'large'}{worst}."

    @property
    def rows(self) -> list[tuple[str, str, str]]:
        """Return the rows of the table of responses: name, value, remark."""
        from orbits.design.references import NAMES

        place, found = self.chosen, []
        if place is not None:
            over = f"worst of {place.samples} samples" if place.samples > 1 else "worst of all that coexists"
            exceeded = self.simulated > place.worst
            if exceeded:
                found.append(
                    ("recommended", f"at least {self.shown('peak', self.simulated)}", "by simulation")
                )
            found.append(
                ("by diagrams" if exceeded else "recommended", self.shown("peak", place.worst), over)
            )
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
        """Return the rows about the share of samples in which the machine is quieted, and the kinds of motions."""
        share_text = "not known" if math.isnan(self.works) else f"{100 * self.works:.3g} %"
        found = []
        if not math.isnan(self.target):
            most = self.shown("peak", self.target)
            found.append(("works", share_text, f"of the samples: at most {most} whatever coexists"))
        for kind, name in self._kinds.items():
            share, top = self.met.get(kind, math.nan), self.met.get(f"{kind}_peak", math.nan)
            if math.isnan(share):
                continue
            remark = "of simulated starts" if share > 0.0 or math.isfinite(top) else "not met"
            remark += f"; at most {self.shown('peak', top)}" if math.isfinite(top) else ""
            if kind == "modulated" and BAND[1] in self.met:
                low, mean, high = (self.shown("peak", self.met[end]) for end in BAND)
                remark += f", per period {low} to {high} (mean {mean}); {100 * self.met['modulated_strong']:.3g} % of them strongly"
            found.append((f"  {name}", f"{100 * share:.3g} %", remark))
        return found

    @property
    def load_rows(self) -> list[tuple[str, str, str]]:
        """Return the rows about loads and noise."""
        return [
            (name_text, self.shown(name, self.loads[name]), remark)
            for name, (name_text, remark) in LOADS.items()
            if name in self.loads
        ]

    @property
    def start_rows(self) -> list[tuple[str, str, str]]:
        """Return the rows about the start-up."""
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
        """Return the first sentences about unknown results, and the number of further ones."""
        more = len(self.unknown) - MOST
        return [*self.unknown[:MOST], *([f"{more} more, in the JSON"] if more > 0 else [])]

    @property
    def start_up_at(self) -> str:
        """The excitation of the start-up, in words."""
        sentence = next((text for text in self.assumed if text.startswith("start-up")), "")
        return sentence.partition(" from rest ")[2]

    @property
    def tables(self) -> list[tuple[str, list[tuple[str, str, str]]]]:
        """Return all non-empty tables with their titles."""
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
            diagram, simulated = (self.shown("peak", value) for value in self.checked)
            checked = f"Checked by simulation at the largest response: {simulated}, beside {diagram} of the diagram."
            lines += ["", fitted(checked)]
        for head, sentences in (("assumed", self.assumed), ("not known", self.first_unknown)):
            lines += [fitted(f"{head}: {sentence}") for sentence in sentences]
        return "\n".join(lines)
