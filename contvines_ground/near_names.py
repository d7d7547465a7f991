"""Names that are nearly right."""

import difflib
from collections.abc import Iterable
from typing import Any


def did_you_mean(given: Any, known: Iterable[str]) -> str:
    """ " (did you mean ...?)" where one of the known names is close, else empty."""
    close = difflib.get_close_matches(str(given)[:60], [str(name) for name in known], n=1, cutoff=0.6)
    return f" (did you mean {close[0]!r}?)" if close else ""
