"""Functions that make a chart: loci from all special points of a graph, points of codimension two on them, and loci that leave these."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import BY_NAME, checked
from ..branches.special_point import SpecialPoint
from ..continuation.settings import Settings, hinting
from ..continuation.starts import check_interval
from ..graph import Graph
from ..journal import Journal, NullJournal
from ..long_work import Asked, OnInterrupt, Tell, carried_out, listening
from .chart import Chart
from .charting_run import Charting, ChartProgress
from .starts import of_own_kind
from .tracing import locus


@hinting
@listening()
def chart(
    graph: Graph,
    over: str,
    within: tuple[float, float],
    bounds: tuple[float, float] | None = None,
    depth: int = 2,
    virtual: bool = False,
    regions: bool = True,
    settings: Settings | Mapping[str, Any] | None = None,
    journal: Journal | None = None,
    progress: Asked = None,
    interrupt: OnInterrupt = "raise",
    kinds: Iterable[Kind] | None = None,
) -> Chart:
    """Make a chart of two parameters: a locus from every special point of a graph, and from the points of codimension two found on the loci.

    The loci at which a real motion gains or loses its stability come first.

    Parameters
    ----------
    graph : Graph
        A diagram in the first parameter, made at a value of the second one that lies in ``within``.
    over : str
        Name of the second parameter.
    within : (float, float)
        Interval of the second parameter.
    bounds : (float, float), optional
        Interval of the first parameter; by default that of the graph.
    depth : int
        Generations of points of codimension two from which further loci are traced.
    virtual : bool
        Continue loci beyond borders, and start them at virtual special points, too.
    regions : bool
        Divide the plane into regions, and simulate in each.
    settings : Settings or mapping, optional
    journal : Journal, optional
        Results that it contains are not computed again.
    progress : callable or bool, optional
        Called with a ``ChartProgress`` (``message`` and counts). By default a line on a terminal or in a notebook; False for none.
    interrupt : "raise" or "return"
        On Ctrl-C: raise :class:`contvines.Interrupted`, whose ``graph`` is the unfinished chart, or return the unfinished chart.
        ``contvines.resume(chart)`` continues it.
    kinds : iterable of Kind, optional
        As in :func:`contvines.diagram`: special points of user-defined kinds are followed if the kind has a `locus`, and zeros of their tests along loci
        are points.

    Returns
    -------
    Chart

    Raises
    ------
    ValueError
        If a parameter or interval is unsuitable, or no special point of the graph has a locus.
    Interrupted
        On Ctrl-C.
    """
    within = check_interval(within)
    bounds = check_interval(graph.within if bounds is None else bounds)
    own_kinds = tuple(kind for kind in checked(kinds) if BY_NAME.get(kind.name) is not kind)
    followed = {kind.name for kind in own_kinds if callable(kind.locus)}
    points = [
        point
        for point in graph.special.values()
        if point.kind not in ("end", "user")
        and (point.real or virtual)
        and (not of_own_kind(point) or point.kind in followed)
    ]
    if not points:
        raise ValueError("the graph has no special points, so there is nothing to chart; widen its interval")

    def start(stored: Journal, report: Tell | None) -> tuple[Chart, Callable[[], None]]:
        options = Settings.of(settings), stored, report, own_kinds
        run = Charting(graph, over, within, bounds, virtual, *options)

        def carry_on() -> None:
            for point in sorted(points, key=lambda point: not _ends_stability(graph, point)):
                run.add_special(point)
            run.work(depth)
            if regions:
                run.divide()
            run.finish()

        return run.chart, carry_on

    return carried_out(start, journal, progress, interrupt)


def _ends_stability(graph: Graph, point: SpecialPoint) -> bool:
    """Whether a real motion gains or loses its stability at a special point."""
    branch = graph.branches.get(point.branch)
    if branch is None or not branch.real:
        return False
    near = Settings.located * (graph.within[1] - graph.within[0])
    return any(abs(point.value - end) <= near for pair in branch.stable_intervals() for end in pair)


@listening()
def chart_of_one(
    graph: Graph,
    label: str,
    over: str,
    within: tuple[float, float],
    virtual: bool = False,
    progress: Callable[[ChartProgress], None] | None = None,
    kinds: Iterable[Kind] | None = None,
) -> Chart:
    """Make a chart of the locus of one special point of a graph, with the points of codimension two on it.

    Parameters
    ----------
    graph : Graph
    label : str
        Label of the special point.
    over, within, virtual, progress
        As for :func:`chart`.
    kinds
        As for :func:`locus`.

    Raises
    ------
    ValueError
        As :func:`contvines.locus` does.
    """
    intervals = check_interval(within), check_interval(graph.within)
    run = Charting(graph, over, *intervals, virtual, Settings(), NullJournal(), progress)
    found = locus(
        graph.special[label],
        over,
        within,
        bounds=graph.within,
        virtual=virtual,
        progress=run.tell_points,
        kinds=kinds,
    )
    run.chart.loci[label] = found
    run.mark(found)
    run.chart.message = "finished"
    run.finish()
    return run.chart


__all__ = ["ChartProgress", "chart", "chart_of_one"]
