"""The kernels of a problem, each compiled once by itself and called by address: for code that is not run often enough to have them inside.

What inlines the kernels takes seconds to compile, for every machine anew; what calls them is compiled once for all. A call takes
some nanoseconds.
"""

from __future__ import annotations

from collections import deque
from functools import cache, cached_property
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np

from contvines_ground.by_address import (
    NOTHING,
    NUMBER,
    VECTOR,
    WHOLE,
    address_of,
    caller,
    loader,
    own_digest,
)
from contvines_ground.kept import OPTIONS, Keeper
from contvines_ground.parts import part, whole

kernel: Any = None  # these are put in per set of kernels
unpack: Any = None


def _linearise(at, u, p):
    data, work = unpack(at)
    return kernel(data, u, p, work)


def _bordered(at, border, target, step, tangent):
    data, work = unpack(at)
    return kernel(data, work, border, target, step, tangent)


def _inspect(at, u, p, row):
    data, work = unpack(at)
    kernel(data, u, p, work, row)


KINDS: dict[Any, tuple[Any, ...]] = {
    _linearise: (WHOLE, VECTOR, NUMBER),
    _bordered: (WHOLE, VECTOR, NUMBER, VECTOR, VECTOR),
    _inspect: (WHOLE, VECTOR, NUMBER, VECTOR),
}


_call: Any = None


def linearise(kernels, u, p, at):
    """`linearise` of the protocol, by address: `kernels` is a tuple of those of linearise, bordered and inspect."""
    return _call(kernels[0], at, u, p)


def bordered(kernels, at, border, target, step, tangent):
    """`bordered` of the protocol."""
    return _call(kernels[1], at, border, target, step, tangent)


def inspect(kernels, u, p, at, row):
    """`inspect` of the protocol."""
    _call(kernels[2], at, u, p, row)


@cache
def callers() -> dict[str, Any]:
    """The three of the protocol for compiled code; `Addressed.all` stands for the data, the address of what is kept for the workspace."""
    made = {}
    for function, kinds in zip((linearise, bordered, inspect), KINDS.values(), strict=True):
        call = caller(NOTHING if function is inspect else NUMBER, *kinds)
        made[function.__name__] = part(forceinline=True, **OPTIONS)(
            FunctionType(function.__code__, {**globals(), "_call": call}, function.__name__)
        )
    return made


class Kept(NamedTuple):
    """Data and workspace of a problem where compiled code finds them.

    Attributes
    ----------
    kernels : Addressed
        For tuples of these types.
    at : int
        Address; the first argument of each of them.
    memory : ndarray
        In which they stand.
    content : tuple
        Data and workspace, whose arrays live as long as this.
    """

    kernels: Addressed
    at: int
    memory: np.ndarray
    content: tuple[Any, Any]


class Addressed:
    """Where the kernels are that take data and workspace of certain types by address.

    Each is compiled when it is first asked for.

    Attributes
    ----------
    linearise : int
        Address of (at, u, p) -> residual; see the protocol of problems.
    bordered : int
        Address of (at, border, target, step, tangent) -> sign.
    inspect : int
        Address of (at, u, p, row).
    """

    def __init__(self, kernels: Any, kind: Any, suffix: str) -> None:
        self._kernels, self._kind, self._suffix = kernels, kind, suffix

    @cached_property
    def linearise(self) -> int:
        return self._compiled(_linearise, self._kernels.linearise)

    @cached_property
    def bordered(self) -> int:
        return self._compiled(_bordered, self._kernels.bordered)

    @cached_property
    def inspect(self) -> int:
        return self._compiled(_inspect, self._kernels.inspect)

    @property
    def all(self) -> tuple[int, int, int]:
        """Addresses of linearise, bordered, inspect."""
        return self.linearise, self.bordered, self.inspect

    def _compiled(self, function: Any, inner: Any) -> int:
        name = f"{function.__name__.strip('_')}{self._suffix}"
        copy = FunctionType(
            function.__code__, {**globals(), "kernel": inner, "unpack": loader(self._kind)}, name
        )
        copy.__qualname__, copy.__module__ = name, __name__
        return address_of(whole(cache=True, **OPTIONS)(copy), *KINDS[function])


class Outlined:
    """The kernels of one sort of problems, by address.

    Parameters
    ----------
    kernels : object
        With compiled functions ``linearise``, ``bordered`` and ``inspect``; see the protocol of problems.
    digest : str
        Of the kernels' sources: under it what is compiled here is kept on disk.
    """

    def __init__(self, kernels: Any, digest: str) -> None:
        suffix = f"_{digest}_{own_digest()}"
        self._keeper = Keeper(lambda kind, mark: Addressed(kernels, kind, suffix + mark), suffix)
        # most calls in a row are about one problem, or about two that are compared
        self._recent: deque[Kept] = deque(maxlen=2)

    def keep(self, data: Any, work: Any) -> Kept | None:
        """Data and workspace, kept; None if they are more than numbers, arrays and tuples of these."""
        for known in self._recent:
            if known.content[0] is data and known.content[1] is work:
                return known
        content = (data, work)
        found = self._keeper.keep(content)
        if found is None:
            return None
        kept = Kept(*found, content)
        self._recent.append(kept)
        return kept


_known: dict[tuple[Any, ...], Outlined] = {}


def outlined(kernels: Any, digest: str) -> Outlined:
    """The kernels by address; one for all who ask for the same ones."""
    key = kernels.linearise, kernels.bordered, digest
    if key not in _known:
        _known[key] = Outlined(kernels, digest)
    return _known[key]
