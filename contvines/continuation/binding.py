"""Binding the continuation loop to the kernels of a problem.

One source (loop.py, corrector.py): ``bind`` copies the functions with other globals. What runs over the unknowns is taken
from lengths.py for compiled problems and from arrays.py for others. For compiled problems the copies are compiled and cached on disk under a name that carries a digest of the kernels' sources, so that a cached
loop is never older than the kernels in it.
"""

from __future__ import annotations

import hashlib
import types
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from . import aims, bracketing, corrector, lengths, loop, step_rule
from .step_rule import BY_ANGLE, StepRule, by_angle

if TYPE_CHECKING:
    from contvines_ground.kept import Keeper

    from .kept import Kept


class Bound(NamedTuple):
    """``march`` and ``points`` with the kernels of a problem inside; compiled, ``points`` is had from the ``keeper`` of its first argument.

    There are two, as each is compiled together with all that it calls.
    """

    march: Callable[..., Any]
    points: Callable[..., Any]
    keeper: Kept | None = None


# Kernels and loop allocate nothing, so they do without reference counts: counting the arrays of a workspace in
# and out of every call would cost more than the mathematics of a small problem.
OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}

SUMS = (
    "correction_size",
    "add",
    "remainder",
    "fix_parameter",
    "plane",
    "compare",
    "orient",
    "hermite",
    "distance",
    "put",
    "extrapolate",
)

_bound: dict[tuple[Any, ...], Bound] = {}


def copy_with(function: types.FunctionType, suffix: str = "", **names: Any) -> types.FunctionType:
    """The function with some of its globals replaced."""
    copy = types.FunctionType(
        function.__code__, {**function.__globals__, **names}, function.__name__, function.__defaults__
    )
    copy.__qualname__ = function.__qualname__ + suffix
    copy.__module__ = function.__module__
    copy.__doc__ = function.__doc__
    return copy


def bind(kernels: Any, rule: StepRule = BY_ANGLE) -> Bound:
    """The continuation loop for these kernels and this step rule; made once per set of them and process."""
    key = (kernels.linearise, kernels.bordered, kernels.inspect, bool(kernels.compiled), rule.judge)
    if key not in _bound:
        _bound[key] = _make(kernels, rule)
    return _bound[key]


def _make(kernels: Any, rule: StepRule) -> Bound:
    functions = {"linearise": kernels.linearise, "bordered": kernels.bordered, "inspect": kernels.inspect}
    if not kernels.compiled:
        from . import arrays

        sums = {name: getattr(arrays, name) for name in SUMS}
        improve = copy_with(corrector.improve, **sums)
        correct = copy_with(corrector.correct, improve=improve, **sums, **functions)
        march = copy_with(loop.march, correct=correct, judge=rule.judge, **sums, **functions)
        return Bound(march, copy_with(corrector.points, improve=improve, **sums, **functions))
    from numba import njit

    from contvines_ground.outlined import outlined
    from contvines_ground.parts import whole

    from ..problems.kernels import kernels_digest
    from .kept import Kept

    digest = kernels_digest(kernels)
    suffix = f"_{digest}_{_loop_digest()}"
    inside, sums, search = _pieces()
    improve = copy_with(corrector.improve, suffix, **sums)
    # A call would hand over three hundred numbers, the arrays of the workspace: as dear as a point of a short word. Inlined before it
    # is compiled, the corrector is optimised once; inlined by force afterwards, twice.
    inlined = njit(inline="always", **OPTIONS)
    correct = inlined(copy_with(corrector.correct, suffix, improve=inlined(improve), **sums, **functions))
    own = (
        rule is not BY_ANGLE
    )  # a user's function may change while its loop is kept on disk: compiled in every process
    judge = compiled_rule(rule) if own else inside(copy_with(by_angle, suffix))
    march = whole(cache=not own, **OPTIONS)(
        copy_with(loop.march, suffix, correct=correct, judge=judge, **sums, **functions)
    )

    def inlining() -> Any:
        names = {"unpack": inside(_itself), "improve": inside(improve), **sums, **functions, **search}
        return whole(cache=True, **OPTIONS)(copy_with(corrector.points, suffix, **names))

    return Bound(march, corrector.points, Kept(outlined(kernels, digest), _keeper(), inlining))


def _itself(frame):
    return frame


@cache
def _pieces() -> tuple[Callable[..., Any], dict[str, Any], dict[str, Any]]:
    """What compiles parts of the two functions that are kept on disk, what runs over the unknowns, and what looks for a zero along a chord."""
    from contvines_ground.parts import part

    inside, suffix = part(**OPTIONS), f"_{_loop_digest()}"
    sums = {name: inside(copy_with(getattr(lengths, name), suffix)) for name in SUMS}
    known = {
        name: inside(copy_with(getattr(bracketing, name), suffix))
        for name in ("begin", "best", "_add", "_ahead")
    }
    follow = inside(copy_with(bracketing.follow, suffix, _add=known.pop("_add"), _ahead=known.pop("_ahead")))
    sorts = {name: inside(copy_with(getattr(aims, name), suffix)) for name in ("_belongs", "_size")}
    multiplier = inside(copy_with(aims.multiplier, suffix, **sorts))
    probe = inside(copy_with(aims.probe, suffix, multiplier=multiplier))
    return inside, sums, {**known, "follow": follow, "probe": probe}


@cache
def _keeper() -> Keeper:
    """Of the compiled `points` that calls kernels by address: one for all problems."""
    from contvines_ground.by_address import loader, own_digest
    from contvines_ground.kept import Keeper
    from contvines_ground.outlined import callers
    from contvines_ground.parts import whole

    inside, sums, search = _pieces()
    suffix = f"_{_loop_digest()}_{own_digest()}"
    improve = inside(copy_with(corrector.improve, suffix, **sums))

    def make(kind: Any, mark: str) -> Any:
        names = {"unpack": loader(kind), "improve": improve, **sums, **callers(), **search}
        return whole(cache=True, **OPTIONS)(copy_with(corrector.points, suffix + mark, **names))

    return Keeper(make, suffix)


def compiled_rule(rule: StepRule) -> Any:
    """A user's rule, compiled; as it is if that has been done."""
    from numba import njit

    return rule.judge if hasattr(rule.judge, "py_func") else njit(**OPTIONS)(rule.judge)


def _loop_digest() -> str:
    """Of the loop's own files: numba looks only at the one that defines a function, not at what it calls, nor at how it is compiled."""
    digest = hashlib.blake2b(Path(__file__).read_bytes(), digest_size=4)
    for module in (aims, bracketing, corrector, lengths, loop, step_rule):
        digest.update(Path(str(module.__file__)).read_bytes())
    return digest.hexdigest()
