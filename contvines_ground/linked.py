"""Functions compiled to optimised intermediate code only, which is linked into their callers; see `contvines_ground.parts`.

What is used of numba's inner rooms is the same from 0.60 to 0.68.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from numba import njit
from numba.core import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler_machinery import register_pass
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import NativeLowering

from contvines_ground.compiler import Compiler


class _Library(JITCodeLibrary):
    """Code that is linked into other libraries: optimised as any, but not handed to the engine, which would make machine code of it."""

    def _finalize_final_module(self) -> None:
        self._finalized = True


class _Nobody:
    """Stands for the function by which Python would call a part; numba keeps what it knows of a function under it."""


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(NativeLowering):
    _name = "lowering_of_a_part"

    def run_pass(self, state: Any) -> bool:
        target, flags = state.targetctx, state.flags
        state.library = _Library(target.codegen(), state.func_id.func_qualname)
        flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
        super().run_pass(state)
        state.library.finalize()
        nobody = _Nobody()
        target.insert_user_function(nobody, state.cr.fndesc, [state.library])
        state.cr = state.cr._replace(cfunc=nobody)
        return True


class _Compiler(Compiler):
    replaced: ClassVar[dict[Any, Any]] = {**Compiler.replaced, NativeLowering: _Lowering}


class Part(CPUDispatcher):
    """What the decorator `part` makes of a function."""

    def __init__(
        self,
        function: Callable[..., Any],
        locals: dict[str, Any] | None = None,  # in the order in which numba makes copies
        options: dict[str, Any] | None = None,
    ) -> None:
        super().__init__(function, locals or {}, {**(options or {}), "nopython": True}, _Compiler)
        self._whole: Any = None

    def called_by(self, whole: Any) -> None:
        """What Python is to call in place of this function, which calls it: one that is kept on disk. The first one stays."""
        self._whole = self._whole or whole

    def get_call_template(self, args: Any, kws: Any) -> Any:
        # one compilation for all numbers of a type, be they written out or not: inlined, those written out are known all the same
        return super().get_call_template([types.unliteral(kind) for kind in args], kws)

    def add_overload(self, cres: Any) -> None:
        self.overloads[tuple(cres.signature.args)] = cres  # where Python does not find it

    def _compile_for_args(self, *args: Any, **kws: Any) -> Any:
        itself: Any = self
        if self._whole is None:
            options = {name: value for name, value in self.targetoptions.items() if name != "nopython"}
            self._whole = njit(**options)(self.py_func)
        found = self._whole._compile_for_args(*args, **kws)
        itself._insert([itself.typeof_pyval(value)._code for value in args], found, False)
        return found
