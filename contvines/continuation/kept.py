"""What `points` is handed in every call, kept where compiled code finds it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from contvines_ground.kept import Keeper
from contvines_ground.outlined import Outlined


class Kept:
    """Keeps what the engines of one set of kernels hand to the compiled `points`.

    Parameters
    ----------
    outlined : Outlined
        The kernels by address.
    points : Keeper
        Of the function that calls them so: the same for all kernels.
    inlined : callable
        Makes the function that has them inside, for problems whose data are more than arrays and numbers.
    """

    def __init__(self, outlined: Outlined, points: Keeper, inlined: Callable[[], Any]) -> None:
        self.outlined, self.points, self.inlined = outlined, points, inlined
        self._whole: Any = None

    def keep(self, arguments: tuple[Any, ...]) -> tuple[Callable[..., Any], Any, Any]:
        """The function for such arguments, what stands for them in its calls, and what has to live as long as that.

        Parameters
        ----------
        arguments : tuple
            Data, workspace, and what else `contvines.continuation.corrector.points` takes. Their arrays have to be kept elsewhere.
        """
        data, work, *others = arguments
        kept = self.outlined.keep(data, work)
        found = None if kept is None else self.points.keep((kept.kernels.all, kept.at, *others))
        if found is None:
            if self._whole is None:
                self._whole = self.inlined()
            return self._whole, arguments, None
        function, at, memory = found
        return function, at, (kept, memory)
