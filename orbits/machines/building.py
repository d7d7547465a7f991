"""A machine from its settings, as files and studies keep them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from orbits.machines.base import Model
from orbits.machines.catalogue import model_class


def build(settings: Mapping[str, Any]) -> Model:
    """The machine with these settings, `name` among them (see `Model.settings`)."""
    values = dict(settings)
    if values.pop("units", None):
        from orbits.machines.physical import physical

        return physical(str(values.pop("name")), values, bool(values.pop("unusual", False)))
    return model_class(str(values.pop("name")))(**values)
