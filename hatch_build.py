"""Build hook: wheels and editable installs carry the native core, compiled on the way.

The system's compiler is used; where there is none, `ziglang` (a compiler in a wheel). ``CONTVINES_ZIG_TARGET`` names a target
for zig, as ``x86_64-linux-gnu.2.17`` for wheels that run on old systems, and ``CONTVINES_WHEEL_PLATFORM`` the wheel's platform.
If compiling fails, the wheel is made without the native core and says so; the reference core in numpy then computes.
"""

from __future__ import annotations

import importlib.util
import os
import platform
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


def _recipe() -> Any:
    path = Path(__file__).resolve().parent / "contvines" / "core" / "build.py"
    spec = importlib.util.spec_from_file_location("contvines_core_build", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class CustomBuildHook(BuildHookInterface):
    """Compiles `native/` for the wheel."""

    def dependencies(self) -> list[str]:
        recipe = _recipe()
        wanted = os.environ.get("CONTVINES_ZIG_TARGET") or recipe.compiler() is None
        return [recipe.ZIG] if wanted and self.target_name == "wheel" else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if self.target_name != "wheel":
            return
        recipe = _recipe()
        target = os.environ.get("CONTVINES_ZIG_TARGET", "")
        try:
            made = recipe.build(command=recipe.zig(target) if target else None)
        except recipe.NotBuilt as error:
            self.app.display_warning(f"contvines is built without its native core: {error}")
            return
        root = Path(self.root)
        build_data["artifacts"] += [str(path.relative_to(root)) for path in made]
        build_data["pure_python"] = False
        # one processor's code also where Python itself is universal
        own = sysconfig.get_platform().replace("universal2", platform.machine())
        name = os.environ.get("CONTVINES_WHEEL_PLATFORM") or own
        build_data["tag"] = f"py3-none-{name.replace('-', '_').replace('.', '_')}"
