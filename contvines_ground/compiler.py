"""numba's compiler, which asks itself less often.

Half of what numba takes to compile a function is spent on finding out which function a call means. The options of the compiler are part
of each such question, and are compared one by one, thirty thousand times in a first run; and nine calls of ten are of a function and
types that were asked for before. Here options that do not change any more are compared as a whole, and answers are remembered.

What is used of numba's inner rooms is the same from 0.60 to 0.68.
"""

from __future__ import annotations

from types import FunctionType, SimpleNamespace
from typing import Any, ClassVar

from numba import version_info
from numba.core import typed_passes, typeinfer
from numba.core.compiler import CompilerBase, DefaultPassBuilder, Flags
from numba.core.compiler_machinery import register_pass
from numba.core.targetconfig import ConfigStack
from numba.core.types import Function

NEWEST = (0, 68)
if version_info.short > NEWEST:
    raise ImportError(f"the inner rooms of numba {version_info.string} are not known here")


class _Given(Flags):
    """The options of one compilation."""

    __slots__ = ()

    def copy(self) -> _Settled:
        """For the stack on which whoever compiles a part of this finds them."""
        return _Settled(self)


class _Settled(Flags):
    """Options that nobody changes any more."""

    __slots__ = ("_all",)
    _number = hash(Flags())  # numba's, which is one for all options

    def __init__(self, given: Flags) -> None:
        super().__init__(given)
        self._all = super().values()

    def copy(self) -> Flags:
        return Flags(self)

    def values(self) -> dict[str, Any]:
        return self._all

    def __hash__(self) -> int:
        return self._number

    def __eq__(self, other: object) -> Any:
        return self is other or super().__eq__(other)


_answers: dict[Any, tuple[Any, Any]] = {}


class _Inferer(typeinfer.TypeInferer):
    """Remembers which signature of a function a call means."""

    def resolve_call(self, fnty: Any, pos_args: Any, kw_args: Any) -> Any:
        if type(fnty) is not Function or kw_args:
            return super().resolve_call(fnty, pos_args, kw_args)
        key = self.context, fnty, tuple(pos_args), ConfigStack.top_or_none()
        found = _answers.get(key)
        if found is None:
            signature = super().resolve_call(fnty, pos_args, kw_args)
            if signature is not None:
                _answers[key] = signature, fnty.get_impl_key(signature)
            return signature
        signature, implementation = found
        # the last answer says what is called; it may have been for other options
        fnty._impl_keys[signature.args] = implementation  # pyright: ignore[reportAttributeAccessIssue]
        return signature


def _with_names(function: Any, **names: Any) -> Any:
    return FunctionType(
        function.__code__,
        {**function.__globals__, **names},
        function.__name__,
        function.__defaults__,
        function.__closure__,
    )


_stage = _with_names(
    typed_passes.type_inference_stage,
    typeinfer=SimpleNamespace(**{**vars(typeinfer), "TypeInferer": _Inferer}),
)


@register_pass(mutates_CFG=True, analysis_only=False)
class _Inference(typed_passes.NopythonTypeInference):
    _name = "type_inference_with_memory"
    run_pass = _with_names(typed_passes.BaseTypeInference.run_pass, type_inference_stage=_stage)


class Compiler(CompilerBase):
    """Makes what numba's own makes."""

    replaced: ClassVar[dict[Any, Any]] = {typed_passes.NopythonTypeInference: _Inference}
    """Passes in whose place others run."""

    def __init__(
        self,
        typingctx: Any,
        targetctx: Any,
        library: Any,
        args: Any,
        return_type: Any,
        flags: Any,
        locals: Any,
    ) -> None:
        super().__init__(typingctx, targetctx, library, args, return_type, _Given(flags), locals)

    def define_pipelines(self) -> list[Any]:
        manager = DefaultPassBuilder.define_nopython_pipeline(self.state)
        manager.passes = [(self.replaced.get(step, step), name) for step, name in manager.passes]
        manager.finalize()
        return [manager]
