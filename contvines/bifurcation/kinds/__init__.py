"""The kinds of special points: one file each. Labels, marks in pictures, tables, legends, detection and switching follow from them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..kind import Kind
from . import (
    branch_point,
    corner,
    end,
    event,
    fold,
    homoclinic,
    hopf,
    neimark_sacker,
    period_doubling,
    stick,
    switch,
    switch_graze,
    symmetry_breaking,
    user,
    vanishing_event,
    velocity_graze,
    wall_graze,
)
from .codimension_two import CODIMENSION_TWO as CODIMENSION_TWO

#: The built-in kinds along a branch, in the order in which they are asked. Borders that are met at once take the first of these names.
KINDS: tuple[Kind, ...] = tuple(
    file.KIND
    for file in (
        fold,
        symmetry_breaking,
        period_doubling,
        neimark_sacker,
        hopf,
        branch_point,
        stick,
        velocity_graze,
        wall_graze,
        vanishing_event,
        switch_graze,
        corner,
        switch,
        homoclinic,
        event,
        user,
        end,
    )
)
BY_NAME: dict[str, Kind] = {kind.name: kind for kind in KINDS}
LABELS: dict[str, str] = {kind.name: kind.label for kind in KINDS}
BORDERS: tuple[str, ...] = tuple(kind.name for kind in KINDS if kind.border)
#: names of files up to version 0.2 -> names of today
RENAMED = {"chatter": "vanishing-event"}


def kind_named(name: str, own: Mapping[str, Kind] = BY_NAME) -> Kind:
    """The kind of this name; a problem's own border kinds that are not in the table are borders drawn plainly."""
    return own.get(name) or BY_NAME.get(name) or CODIMENSION_TWO.get(name) or Kind(name, "US")


def checked(kinds: Iterable[Kind] | None) -> tuple[Kind, ...]:
    """The kinds that a diagram looks for.

    Raises
    ------
    ValueError
        If they are no list, one is no :class:`~contvines.Kind`, has no test function, or two share a name or a label.
    """
    if not (kinds is None or isinstance(kinds, Iterable)):
        raise ValueError(f"kinds = {kinds!r}: a list is asked for; kinds=[*contvines.KINDS, yours] would do")
    chosen = KINDS if kinds is None else tuple(kinds)
    names: dict[str, Kind] = {}
    for kind in chosen:
        if not isinstance(kind, Kind):
            raise ValueError(
                f"kinds: {kind!r} is no contvines.Kind; kinds=[*contvines.KINDS, yours] would do"
            )
        if BY_NAME.get(kind.name) is not kind:
            if kind.test is None:
                raise ValueError(
                    f"kinds: {kind.name} has no test function; test=lambda point: ... gives it one"
                )
            used = (*KINDS, *CODIMENSION_TWO.values(), *names.values())
            if any(kind.name == other.name or kind.label == other.label for other in used):
                raise ValueError(
                    f"kinds: the name {kind.name!r} or the label {kind.label!r} is used by another kind; choose others"
                )
        names[kind.name] = kind
    return chosen
