"""Names that are nearly right."""

import difflib
from collections.abc import Iterable


def did_you_mean(given: object, known: Iterable[str]) -> str:
    """ " (did you mean ...?)" where one of the known names is close, else empty."""
    close = difflib.get_close_matches(str(given)[:60], [str(name) for name in known], n=1, cutoff=0.6)
    return f" (did you mean {close[0]!r}?)" if close else ""


# what machines are asked beside their parameters, which share one list of keywords with these
ASKED = ("word", "periods", "guess", "start", "count", "seed", "size", "time", "events", "over")


def no_parameter(given: object, machine: str, known: Iterable[str]) -> str:
    """The sentence that a machine has no such parameter, and which it has."""
    names = list(known)
    return f"{given} is no parameter of {machine}{did_you_mean(given, [*names, *ASKED])}; it has {', '.join(names)}"
