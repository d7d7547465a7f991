"""A machine from its settings, as files and studies keep them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from orbits.machines.names import model_class

if TYPE_CHECKING:
    from orbits.machines.base import Model
    from orbits.machines.structure import Structure


def build(settings: Mapping[str, Any]) -> Model | Structure:
    """The machine with these settings, `name` among them (see `Model.settings`)."""
    if "structure" in settings:
        from orbits.machines.structure import structure_again

        return structure_again(settings)
    if settings.get("units"):
        from orbits.machines.physical.machine import physical_again

        return physical_again(settings)
    values = {key: value for key, value in settings.items() if key not in ("name", "units")}
    return model_class(str(settings["name"]))(**values)
