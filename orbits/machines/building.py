"""A machine from its settings, as files and studies keep them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from orbits.machines.catalogue import model_class


def build(settings: Mapping[str, Any]) -> Any:
    """The machine with these settings, `name` among them (see `Model.settings`)."""
    values = dict(settings)
    if "structure" in values:
        from orbits.machines.structure.structure import structure_again

        return structure_again(values)
    if values.pop("units", None):
        from orbits.machines.physical import physical

        return physical(str(values.pop("name")), values, bool(values.pop("unusual", False)))
    return model_class(str(values.pop("name")))(**values)
