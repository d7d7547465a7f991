"""Names of the states of a flow, and of what is measured of them."""

from __future__ import annotations

from collections.abc import Sequence

OF_STATES = ("max", "min", "mean")
TAKEN = ("norm", "period")


def checked_names(given: Sequence[str] | None, count: int) -> tuple[str, ...]:
    """The names of so many states: those given, or x0, x1, ...

    Raises
    ------
    ValueError
        If they are not as many, or one cannot be used.
    """
    if given is None:
        return tuple(f"x{j}" for j in range(count))
    if isinstance(given, str) or not all(isinstance(name, str) and name.isidentifier() for name in given):
        raise ValueError(f"states = {given!r} must be names, for example ('x', 'y')")
    if len(given) != count:
        raise ValueError(f"states = {tuple(given)!r} has {len(given)} names; the flow has {count} states")
    wrong = next((name for k, name in enumerate(given) if name in (*given[:k], *TAKEN)), None)
    if wrong is not None:
        why = "is that of a measure" if wrong in TAKEN else "is there twice"
        raise ValueError(f"states: the name {wrong!r} {why}; choose another one")
    return tuple(given)
