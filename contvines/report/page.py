"""The HTML page of a report: data, program and plotly in one self-contained file."""

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
        Graphs and charts need their problems, so that orbits can be drawn.
    target : path
        Of the page; its name ends in .html.
    source : path
        The result's file, for the commands that the page shows.
    trust : bool
        Whether these commands need the option ``--trust``, as the file names Python code.

    Returns
    -------
    Path

    Raises
    ------
    ValueError
        If the page cannot be written, or plotly is not installed.
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
    """Return the kind of a result's page (a key of `PROGRAMS`) and the data for it."""
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
    """Return the HTML text of a page of a kind (a key of `PROGRAMS`) that shows `data`."""
    folder = files("contvines.report")
    parts = {
        "TITLE": html.escape(f"{data['source']}: {kind}", quote=False),
        "STYLE": folder.joinpath("page.css").read_text(encoding="utf-8"),
        "BODY": folder.joinpath(f"{kind}.html").read_text(encoding="utf-8"),
        "MOTION": folder.joinpath("motion.html").read_text(encoding="utf-8"),  # a part of some bodies
        "PROGRAM": "\n".join(folder.joinpath(name).read_text(encoding="utf-8") for name in PROGRAMS[kind]),
        "PLOTLY": _packed(_plotly()),
        "DATA": _packed(json_text(data, indent=None)),
    }
    text = folder.joinpath("page.html").read_text(encoding="utf-8")
    for name, part in parts.items():
        text = text.replace(f"<!--{name}-->", part)
    return text


def check_page(place: Path, plotly: bool = True) -> None:
    """Check, before any work, that a page can be written.

    Raises
    ------
    ValueError
        If not; the message suggests a valid name, or names the package that must be installed.
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
