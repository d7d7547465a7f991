"""Later: a number of a special point that is worked out when somebody first asks for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Later:
    """A field of a dataclass that is a number or None, or is set to a function without arguments that returns one.

    The function is called once. Coefficients of normal forms and simulations of special points are a good part of the cost of a
    diagram, and surveys of many diagrams look at neither.
    """

    def __set_name__(self, owner: type, name: str) -> None:
        self.place = "_" + name

    def __get__(self, instance: Any, owner: type | None = None) -> float | None:
        if instance is None:
            return None  # the default
        value: Any = vars(instance)[self.place]
        if callable(value):
            value = vars(instance)[self.place] = value()
        return value

    def __set__(self, instance: Any, value: float | Callable[[], float | None] | None) -> None:
        vars(instance)[self.place] = value
