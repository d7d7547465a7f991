"""End: a branch comes to an end of the interval."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind(
    "end",
    "EP",
    text="end of the interval",
    marker="|",
    filled=False,
    nothing="the interval ends here; no branch leaves",
)
