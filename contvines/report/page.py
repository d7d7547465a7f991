"""The page itself: data, program and plotly packed into one file that asks for nothing from outside."""

from __future__ import annotations

import base64
import gzip
import html
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contvines.shared.files import refuse_place

from ..export import json_text
from ..shared.on_demand import needed

if TYPE_CHECKING:
    from ..graph import Graph
    from ..loci.chart import Chart
    from ..survey.results import Survey

PROGRAMS = {
    "graph": ("common.js", "orbit.js", "graph.js", "attractors.js"),
    "chart": ("common.js", "orbit.js", "chart.js"),
    "survey": ("common.js", "survey.js"),
}


def write_report(
    result: Graph | Chart | Survey, target: str | Path, source: str | Path, trust: bool = False
) -> Path:
    """Write a result as one self-contained HTML page.

    Parameters
    ----------
    result : Graph, Chart or Survey
        Graphs and charts loaded with their problems, so that orbits can be drawn.
    target : path
        The page; its name ends in .html.
    source : path
        The result's file, as the commands on the page shall name it.
    trust : bool
        Whether the file names Python code that these commands must be allowed to run.

    Returns
    -------
    Path

    Raises
    ------
    ValueError
        If the place cannot be written, or plotly is not installed.
    """
    place = Path(target)
    check_page(place)
    kind, data = content_of(result, str(source))
    data["trust"] = trust
    try:
        place.write_text(page(data, kind), encoding="utf-8")
    except OSError as error:
        raise ValueError(f"{place}: the page cannot be written ({error.strerror}).") from None
    return place


def content_of(result: Graph | Chart | Survey, source: str) -> tuple[str, dict[str, Any]]:
    """Which page shows a result, and the data for it."""
    from ..graph import Graph
    from ..loci.chart import Chart

    if isinstance(result, Graph):
        from .contents import contents

        return "graph", contents(result, source)
    if isinstance(result, Chart):
        from .contents import chart_contents

        return "chart", chart_contents(result, source)
    from .contents import survey_contents

    return "survey", survey_contents(result, source)


def page(data: dict[str, Any], kind: str = "graph") -> str:
    """The HTML text of a page of this kind (`PROGRAMS`) that shows `data`."""
    here = files("contvines.report")
    parts = {
        "TITLE": html.escape(f"{data['source']}: {kind}", quote=False),
        "STYLE": here.joinpath("page.css").read_text(encoding="utf-8"),
        "BODY": here.joinpath(f"{kind}.html").read_text(encoding="utf-8"),
        "MOTION": here.joinpath("motion.html").read_text(encoding="utf-8"),  # a part of some bodies
        "PROGRAM": "\n".join(here.joinpath(name).read_text(encoding="utf-8") for name in PROGRAMS[kind]),
        "PLOTLY": _packed(_plotly()),
        "DATA": _packed(json_text(data, indent=None)),
    }
    text = here.joinpath("page.html").read_text(encoding="utf-8")
    for name, part in parts.items():
        text = text.replace(f"<!--{name}-->", part)
    return text


def check_page(place: Path, plotly: bool = True) -> None:
    """Refuse, before any work, a page that could not be written at the end.

    Raises
    ------
    ValueError
        With a name that is accepted, or the installation that is missing.
    """
    if place.suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"{place}: a report is a page, its name must end in .html; use {place.stem}.html.")
    refuse_place(place)
    if plotly:
        _plotly()


def _plotly() -> str:
    return needed("plotly.offline", "report").get_plotlyjs()


def _packed(text: str) -> str:
    return base64.b64encode(gzip.compress(text.encode("utf-8"), 9, mtime=0)).decode("ascii")
