"""`contvines locus`, `chart` and `circle`: follow one or all special points in a second parameter, and the invariant circles of one."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

from .frame import (
    beside,
    check_special,
    draw,
    finished_of,
    held,
    load_file,
    made,
    place_of,
    present,
    refuse_detached,
    refuse_unfinished,
    say,
    tell_result,
    working,
)
from .options import (
    DetailsOption,
    FileArgument,
    FreshOption,
    JsonOption,
    LabelArgument,
    PlotOption,
    QuietOption,
    SizeOption,
    TrustOption,
    VirtualOption,
    amount,
    argument,
    interval,
    option,
)

if TYPE_CHECKING:
    from ..graph import Graph
    from ..loci.chart import Chart


OutputOption = Annotated[
    Path | None,
    option(
        "-o, --output FILE.vines",
        "Result file; by default FILE-LABEL.vines (locus) or FILE-chart.vines in this folder.",
    ),
]


def locus(
    file: FileArgument,
    label: LabelArgument,
    over: Annotated[str, option("--over NAME", "The second parameter.")],
    within: Annotated[
        tuple[str, str],
        option("--within LOW HIGH", "Its interval: numbers, or quantities as '0.1 mm' '0.6 mm'."),
    ],
    output: OutputOption = None,
    plot: PlotOption = None,
    fresh: FreshOption = False,
    virtual: VirtualOption = False,
    quiet: QuietOption = False,
    trust: TrustOption = False,
) -> None:
    """Follow one special point of a result in a second parameter.

    The locus ends with either interval: that of the diagram, and --within.
    """
    from ..loci.charting import chart_of_one

    target = place_of(output, file, f"-{label}.vines")
    graph = load_file(file, trust)
    check_special(graph, file, label)
    refuse_detached(graph, label)
    ends, kinds = interval("--within", within, over, graph.units), None
    if graph.special[label].kind in graph.own_kinds:  # its condition is a function of the study's
        from .study import kept_study, source_of

        source = source_of(file)
        kinds = kept_study(file, source, trust)[0].all_kinds if source else None
    with working("nothing new is kept; run the same command again", quiet) as progress:
        found = chart_of_one(graph, label, over, ends, virtual=virtual, progress=progress, kinds=kinds)
    with held(target, quiet, fresh):
        found.save(target)
    _tell(found, target, plot, quiet)


def chart(
    file: Annotated[
        Path,
        argument("STUDY.toml|FILE.vines", "A study, or a result of diagram."),
    ],
    over: Annotated[
        str | None,
        option("--over NAME", "The second parameter; by default [chart] parameter."),
    ] = None,
    within: Annotated[
        tuple[str, str] | None,
        option(
            "--within LOW HIGH",
            "Its interval, numbers or quantities as '0.1 mm' '0.6 mm'; by default [chart] within.",
        ),
    ] = None,
    output: OutputOption = None,
    plot: PlotOption = None,
    fresh: FreshOption = False,
    virtual: VirtualOption = False,
    quiet: QuietOption = False,
    trust: TrustOption = False,
    details: DetailsOption = False,
) -> None:
    """Chart of two parameters: loci of special points, codimension-two points, regions; an interrupted run goes on."""
    from ..shared.files import is_database
    from .run import diagram
    from .study import read_study

    target, computed = place_of(output, file, "-chart.vines"), is_database(file)
    section = None if computed else read_study(file).chart
    over = over or (None if section is None else section.parameter)
    if computed and (over is None or within is None):
        missing = "--over" if over is None else "--within"
        raise ValueError(f"{missing} is missing: for example --over friction --within 0 0.8.")
    if over is None or (within is None and section is None):
        raise ValueError(
            f"{file}: name the second parameter and its interval: --over friction --within 0 0.8, or a section [chart] with "
            "parameter and within."
        )
    if not computed:  # the diagram first
        diagram(file, quiet=True, fresh=fresh, look=False)
    place = file if computed else beside(file, ".vines")
    graph = load_file(place, trust)
    refuse_unfinished(graph, place)
    if within is not None:
        low, high = interval("--within", within, over, graph.units)
    else:
        assert section is not None
        low, high = section.within
    refuse_detached(
        graph, *(label for label, point in graph.special.items() if point.kind not in ("end", "user"))
    )
    plane = Plane(over, (low, high), virtual)
    with held(target, quiet, fresh):
        found = chart_of(graph, plane, target, quiet, _source(place, target, plane))
    _tell(found, target, plot, quiet, details)


def _tell(found: Chart, target: Path, plot: Path | None, quiet: bool, details: bool = False) -> None:
    """Print where a chart is stored and the chart itself, and draw it."""
    say(f"kept in {target}", quiet)
    if not quiet:
        tell_result(found, target, details)
    draw(plot, found.plot, quiet)


class Plane(NamedTuple):
    """Settings of a chart: the second parameter, its interval, and whether virtual motions are followed."""

    over: str
    within: tuple[float, float]
    virtual: bool

    def fingerprint(self, graph: Graph) -> str:
        """Return the digest that identifies the chart of a diagram with these settings."""
        values = [(point.label, point.kind, point.value) for point in graph.special.values()]
        model = {
            name: value for name, value in graph.model.items() if name != "page"
        }  # wherever its file lies
        parts = "chart", model, graph.parameter, list(graph.within), values
        text = json.dumps([*parts, self.over, list(self.within), self.virtual])
        return hashlib.sha256(text.encode()).hexdigest()


def chart_of(graph: Graph, plane: Plane, target: Path, quiet: bool, source: dict[str, Any] | None) -> Chart:
    """Return the chart of a diagram, from its file if that is finished, otherwise computed; `source` is stored for `contvines rerun`."""
    from ..loci.chart import Chart
    from ..loci.charting import chart as make

    fingerprint, (over, ends, virtual) = plane.fingerprint(graph), plane
    found = finished_of(Chart, target, fingerprint, quiet, problems=False)
    if found is not None:
        say(f"{target} holds the finished chart; nothing to compute.", quiet)
        return found
    study = {"chart": [over, *ends], "source": source}
    return made(
        target, fingerprint, study, quiet, lambda **to: make(graph, over, ends, virtual=virtual, **to)
    )


def _source(diagram: Path, target: Path, plane: Plane) -> dict[str, Any] | None:
    """Return the study stored in a diagram's file, with the settings of the chart; None if the file has no study."""
    from .study import source_of

    stored = source_of(diagram)
    if not stored:
        return None
    place = os.path.relpath(diagram.absolute().parent / stored["study"], target.absolute().parent)
    return {**stored, "study": place, "chart": [plane.over, *plane.within], "virtual": plane.virtual}


def circle(
    file: FileArgument,
    label: Annotated[str, argument("LABEL", "A Neimark-Sacker point, for example NS1.")],
    to: Annotated[
        str | None,
        option(
            "--to VALUE",
            "Last value of the parameter; by default where the circle is half as large as the motion.",
        ),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    json: JsonOption = False,
    trust: TrustOption = False,
) -> None:
    """Follow the invariant circles (modulated motions) of a Neimark-Sacker point until they break up."""
    graph = load_file(file, trust)
    if label not in graph.special:
        points = ", ".join(point.label for point in graph.of_kind("neimark-sacker"))
        raise ValueError(
            f"{file}: {label} is no label of it; its Neimark-Sacker points are {points or 'none'}."
        )
    refuse_detached(graph, label)
    end = None if to is None else amount("--to", to, graph.parameter, graph.units)
    present(graph.special[label].circles(end), json, plot, size)
