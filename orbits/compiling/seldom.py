"""Functions that are interpreted until compiling them pays.

A second of compiling is too much for what a study calls a few times, and too little to go without where it is called for thousands
of borders.
"""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType
from typing import Any

import numpy as np

from orbits.compiling.waiting import cached


class Seldom:
    """A function that is compiled once it has done some work, or where it is kept on disk already.

    Only for functions that add, subtract, multiply, divide and compare: interpreted they give the same numbers to the last digit.

    Parameters
    ----------
    compiled : callable
        The compiled function.
    work : callable
        From the arguments: about how much they ask for, in passes through the innermost loop.
    limit : int
        So much is done without compiling; a pass takes about a microsecond.
    **inner : callable
        Compiled functions that it calls and Python does not, by name.
    """

    def __init__(self, compiled: Any, work: Callable[..., int], limit: int, **inner: Any) -> None:
        self.compiled, self._work, self._left = compiled, work, limit
        written = getattr(compiled, "py_func", compiled)
        known = {name: getattr(function, "py_func", function) for name, function in inner.items()}
        self._interpreted = FunctionType(written.__code__, {**written.__globals__, **known}, written.__name__)
        self._asked = False

    def __call__(self, *arguments: Any) -> Any:
        if not self._asked:
            self._asked = True
            if cached(self.compiled):
                self._left = 0
        if self._left <= 0:
            return self.compiled(*arguments)
        self._left -= self._work(*arguments)
        with np.errstate(all="ignore"):
            return self._interpreted(*arguments)
