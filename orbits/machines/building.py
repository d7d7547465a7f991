"""A machine from its settings, as files and studies keep them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from orbits.machines.catalogue import model_class

if TYPE_CHECKING:
    from orbits.machines.base import Model
    from orbits.machines.structure.structure import Structure


def build(settings: Mapping[str, Any]) -> Model | Structure:
    """The machine with these settings, `name` among them (see `Model.settings`)."""
    values = dict(settings)
    if "structure" in values:
        from orbits.machines.structure.structure import structure_again

        return structure_again(values)
    if values.pop("units", None):
        from orbits.machines.physical import physical

        return physical(str(values.pop("name")), values, bool(values.pop("unusual", False)))
    return model_class(str(values.pop("name")))(**values)
