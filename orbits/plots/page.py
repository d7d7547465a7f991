"""An orbit as HTML, for notebooks."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from contvines.shared.number_text import complex_figures, figures
from orbits.plots.portrait import title
from orbits.plots.shown import quantities

if TYPE_CHECKING:
    from orbits.orbit import Orbit


def page(orbit: Orbit) -> str:
    """What an orbit is, line by line: its motion in words, its parameters, multipliers and least margin.

    Parameters
    ----------
    orbit : Orbit
    """
    multipliers = complex_figures(orbit.multipliers[:8])
    least = min(orbit.margins, key=lambda margin: margin.value, default=None)
    rows = [
        ("motion", title(orbit).split("\n")[0]),
        *quantities(orbit).items(),
        ("multipliers", multipliers or "-"),
        ("least margin", "-" if least is None else f"{figures(least.value)} ({least.kind})"),
    ]
    body = "".join(
        f"<tr><th style='text-align:left'>{html.escape(name)}</th>"
        f"<td style='text-align:left'>{html.escape(text)}</td></tr>"
        for name, text in rows
    )
    return f"<table><tbody>{body}</tbody></table>"
