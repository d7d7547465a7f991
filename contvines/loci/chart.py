"""Chart: loci, points of codimension two and regions in the plane of two parameters, as data that are shown, exported and saved."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from contvines.shared.near_names import did_you_mean

from ..bifurcation.kinds import CODIMENSION_TWO
from ..continuation.settings import hinted
from ..graph.persistence import branch_of, check_branch, check_fields, content_of, fields_of, fits, renamed
from ..journal import Resumable
from ..problems.abilities import notation_of
from ..problems.registry import UnknownFactory, rebuild
from ..shared.figures import PlotOptions
from .adaptive import locus_of
from .locus import Locus, PlanePoint, Turn
from .regions import Region

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..bifurcation.kind import Kind


class ChartOptions(PlotOptions, total=False):
    """Options of :func:`contvines.plots.chart.plot_chart`."""

    labels: bool
    names: bool


@hinted
@dataclass(eq=False)
class Chart(Resumable):
    """Loci, points of codimension two and regions in the plane of two parameters.

    Attributes
    ----------
    parameters : (str, str)
        The parameter of the diagrams, on the x axis, and the second one, on the y axis.
    within : ((float, float), (float, float))
        Intervals of the two parameters.
    loci : dict of Locus
        By label.
    points : dict of PlanePoint
        Points of codimension two, by label.
    regions : list of Region
    crossings : list of dict
        Crossings of two unrelated loci: "on", "value", "error"; see `contvines.loci.charting_run.crossings`.
    model : dict
        Name and parameters of the model.
    settings : dict
    units : dict of str
        Units of the parameters, by name, if they have any.
    notation : dict of str
        Axis labels of the parameters, by name; empty for user-defined equations.
    finished : bool
        False while the computation runs, or after it was interrupted.
    message : str
        State of the computation.
    """

    parameters: tuple[str, str]
    within: tuple[tuple[float, float], tuple[float, float]]
    loci: dict[str, Locus] = field(default_factory=dict)
    points: dict[str, PlanePoint] = field(default_factory=dict)
    regions: list[Region] = field(default_factory=list)
    crossings: list[dict[str, Any]] = field(default_factory=list)
    model: dict[str, Any] = field(default_factory=dict)
    settings: dict[str, Any] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    notation: dict[str, str] = field(default_factory=dict)
    finished: bool = False
    message: str = ""

    def __getitem__(self, label: str):
        for group in (self.loci, self.points):
            if label in group:
                return group[label]
        labels = ", ".join([*self.loci, *self.points]) or "none yet"
        raise KeyError(f"the chart has no label {label!r}; it has {labels}")

    def __contains__(self, label: object) -> bool:
        return label in self.loci or label in self.points

    def __str__(self) -> str:
        from .table import shown

        return shown(self)

    def _repr_html_(self) -> str:
        from .table import page

        return page(self)

    def __repr__(self) -> str:
        state = "" if self.finished else ", unfinished"
        return (
            f"Chart({self.parameters[0]} x {self.parameters[1]}: {len(self.loci)} loci, {len(self.points)} points, "
            f"{len(self.regions)} regions{state})"
        )

    def of_kind(self, kind: str) -> list[PlanePoint]:
        """Return the points of codimension two of one kind.

        Raises
        ------
        ValueError
            If there is no such kind.
        """
        if kind not in CODIMENSION_TWO:
            named = next((name for name, entry in CODIMENSION_TWO.items() if entry.label == kind), None)
            hint = f" (did you mean {named!r}?)" if named else did_you_mean(kind, CODIMENSION_TWO)
            raise ValueError(f"there is no kind {kind!r}{hint}; choose from {', '.join(CODIMENSION_TWO)}")
        return [point for point in self.points.values() if point.kind == kind]

    def to_dict(self) -> dict[str, Any]:
        """Return the chart as a JSON-able dict."""
        result = {
            "parameters": list(self.parameters),
            "within": [list(interval) for interval in self.within],
            "model": self.model,
            "finished": self.finished,
            "message": self.message,
            "loci": [locus.to_dict() for locus in self.loci.values()],
            "points": [point.to_dict() for point in self.points.values()],
            "crossings": self.crossings,
            "regions": [region.to_dict(self.parameters) for region in self.regions],
        }
        return {**result, "units": self.units} if self.units else result

    def plot(self, **options: Unpack[ChartOptions]) -> Figure:
        """Draw the chart as a matplotlib figure; see :func:`contvines.plots.chart.plot_chart`."""
        from ..plots.chart import plot_chart

        return plot_chart(self, **options)

    def to_pandas(self):
        """Return all points of all loci as a data frame; see :func:`contvines.export.frames.chart_frame`."""
        from ..export.frames import chart_frame

        return chart_frame(self)

    def to_xarray(self):
        """Return all points of all loci as a data set; see :func:`contvines.export.frames.chart_dataset`."""
        from ..export.frames import chart_dataset

        return chart_dataset(self)

    def export(self, path: str | Path, to: str | None = None) -> Path:
        """Write the chart for other programs.

        Parameters
        ----------
        path : str or Path
        to : {"csv", "json"}, optional
            By default from the ending of `path`.

        Returns
        -------
        Path
            The written file.

        Raises
        ------
        ValueError
            If there is no such format, or the file cannot be written.
        """
        place = Path(path)
        from ..export.files import export_chart

        return export_chart(self, to or place.suffix.lstrip(".").lower(), place)

    def save(self, path: str | Path) -> None:
        """Write the chart to a .vines file, the format of graphs, too; ``contvines.load`` reads both."""
        from ..store import save

        save(self, path)

    # ------------------------------------------------------------------ to and from a file
    def entries(self) -> Iterator[tuple[str, str, dict[str, Any]]]:
        """Generate the chart's entries of a file as (kind, key, content)."""
        yield "chart", "chart", fields_of(self, "loci", "points", "regions")
        for locus in self.loci.values():
            fields = fields_of(locus, "branch", "marked", "kinds")
            fields["marks"] = None if locus.marked is None else locus.marks
            fields["turns"] = [[turn.index, *turn.value] for turn in locus.turns]
            branch = {f"branch_{name}": value for name, value in content_of(locus.branch).items()}
            yield "locus", locus.label, {**fields, **branch}
        for point in self.points.values():
            yield "plane-point", point.label, fields_of(point, "problem")
        for i, region in enumerate(self.regions):
            yield "region", str(i), fields_of(region)


def chart_from_entries(
    entries: Mapping[str, Mapping[str, dict[str, Any]]],
    *,
    problems: bool = True,
    trust: bool = False,
    kinds: Iterable[Kind] = (),
) -> Chart:
    """Rebuild a chart from the entries that `Chart.entries` generated.

    Parameters
    ----------
    entries : mapping
        kind -> key -> content.
    problems : bool
        Rebuild the problems of the loci, too.
    trust : bool
        Import functions that the file names; see :func:`contvines.problems.registry.rebuild`.
    kinds : iterable of Kind
        User-defined kinds, whose loci are rebuilt, too.
    """
    by_name = {kind.name: kind for kind in kinds if callable(kind.locus)}
    entries = renamed(entries)
    head = dict(next(iter(entries["chart"].values())))
    head["parameters"] = tuple(head["parameters"])
    head["within"] = tuple(tuple(interval) for interval in head["within"])
    chart = Chart(**head)
    marks: dict[str, list[tuple[int, str]] | None] = {}
    for label, content in entries.get("locus", {}).items():
        entry = {k: v for k, v in content.items() if not k.startswith("branch_")}
        parts = {k.removeprefix("branch_"): v for k, v in content.items() if k.startswith("branch_")}
        problem = None
        if problems:
            try:
                description, kind = parts["description"], by_name.get(content["kind"])
                problem = rebuild(description, trust) if kind is None else locus_of(description, trust, kind)
            except UnknownFactory:
                problem = None
        entry["parameters"], entry["within"] = tuple(entry["parameters"]), tuple(entry["within"])
        marks[label] = entry.pop("marks")
        entry["turns"] = tuple(Turn(int(i), (float(p), float(q))) for i, p, q in entry["turns"])
        chart.loci[label] = Locus(branch=branch_of(parts, problem), **entry)
    for label, content in entries.get("plane-point", {}).items():
        entry = dict(content)
        for name in ("parameters", "value", "margins"):
            entry[name] = tuple(entry[name])
        loci = [chart.loci[name].problem for name in entry["on"] if name in chart.loci]
        owners = [each for each in loci if each is not None and each.size == len(entry["u"])]
        problem = owners[0].at(entry["value"][1]) if owners else None
        chart.points[label] = PlanePoint(problem=problem, **entry)
    for label, found in marks.items():
        if found is not None:
            chart.loci[label].marked = tuple((int(i), chart.points[name]) for i, name in found)
    for content in entries.get("region", {}).values():
        chart.regions.append(Region(**{**content, "at": tuple(content["at"])}))
    if "notation" not in head:  # an older file
        chart.notation = notation_of(*(locus.branch.problem for locus in chart.loci.values()))
    check_chart(chart)
    return chart


_MOTION = {"word": str | None, "kind": str | None, "periods": int | None}


def _motions(found: object) -> bool:
    """Whether an object is a list of motions in the format of `problem.simulated_attractors`."""
    return isinstance(found, list) and all(
        fits(motion, dict[str, Any]) and all(fits(motion.get(name), kind) for name, kind in _MOTION.items())
        for motion in found
    )


def check_chart(chart: Chart) -> None:
    """Check the types and shapes of a loaded chart.

    Raises
    ------
    ValueError
        The message names the wrong entry and field.
    """
    check_fields("the chart", chart)
    for label, locus in chart.loci.items():
        check_fields(label, locus)
        check_branch(label, locus.branch)
        if locus.real.shape != locus.branch.values.shape or locus.real.dtype != bool:
            raise ValueError(f"{label}: its arrays are not of the same length")
    for label, point in chart.points.items():
        check_fields(label, point)
        if point.label != label:
            raise ValueError(f"{label}: its label is {point.label!r}")
    for region in chart.regions:
        check_fields("a region", region)
        for place in ({"at": list(region.at), "attractors": region.attractors}, *region.elsewhere):
            motions = place.get("attractors")
            if not fits(place.get("at"), list[float]) or len(place["at"]) != 2 or not _motions(motions):
                raise ValueError("a region has a place or a motion that is none")
    for crossing in chart.crossings:
        if not fits(crossing.get("on"), list[str]) or not fits(crossing.get("value"), dict[str, float]):
            raise ValueError("a crossing has no place")
