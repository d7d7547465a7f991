"""The page itself: data, program and plotly packed into one file that asks for nothing from outside."""

from __future__ import annotations

import base64
import gzip
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..export import json_text
from .contents import contents

if TYPE_CHECKING:
    from ..graph.graph import Graph

MISSING = "a report needs plotly: pip install 'contvines[report]'"


def write_report(graph: Graph, target: str | Path, source: str | Path) -> Path:
    """Write a graph as one self-contained HTML page.

    Parameters
    ----------
    graph : Graph
        Loaded with its problems, so that orbits can be drawn.
    target : path
        The page; its name ends in .html.
    source : path
        The .vines file, as the commands on the page shall name it.

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
    data = contents(graph, str(source))
    try:
        place.write_text(page(data), encoding="utf-8")
    except OSError as error:
        raise ValueError(f"{place}: the page cannot be written ({error.strerror}).") from None
    return place


def page(data: dict[str, Any]) -> str:
    """The HTML text of a page that shows `data`."""
    here = files("contvines.report")
    parts = {
        "TITLE": f"{data['source']}: {data['parameter']}",
        "STYLE": here.joinpath("page.css").read_text(encoding="utf-8"),
        "PROGRAM": here.joinpath("page.js").read_text(encoding="utf-8"),
        "PLOTLY": _packed(_plotly()),
        "DATA": _packed(json_text(data, indent=None)),
    }
    text = here.joinpath("page.html").read_text(encoding="utf-8")
    for name, part in parts.items():
        text = text.replace(f"<!--{name}-->", _escaped(part) if name == "TITLE" else part)
    return text


def check_page(place: Path) -> None:
    """Refuse, before any work, a page that could not be written at the end.

    Raises
    ------
    ValueError
        With the name or the installation that would do.
    """
    if place.suffix.lower() not in (".html", ".htm"):
        raise ValueError(
            f"{place}: a report is a page, its name must end in .html; {place.stem}.html would do."
        )
    if place.is_dir() or not place.parent.is_dir():
        raise ValueError(
            f"{place}: there is no folder {str(place.parent)!r}; make it first, or choose another place."
        )
    _plotly()


def _plotly() -> str:
    try:
        from plotly.offline import get_plotlyjs
    except ImportError:
        raise ValueError(MISSING) from None
    return get_plotlyjs()


def _packed(text: str) -> str:
    return base64.b64encode(gzip.compress(text.encode("utf-8"), 9, mtime=0)).decode("ascii")


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
