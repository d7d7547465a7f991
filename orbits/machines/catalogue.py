"""The machines: one model per file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from orbits.machines.base import Model, ParameterError

NAMES = ("absorber", "coupled")


def model_class(name: str) -> type[Model]:
    """The model called `name` in studies.

    Raises
    ------
    ParameterError
        If there is none.
    """
    if name == "absorber":
        from orbits.machines.absorber.machine import Absorber

        return Absorber
    if name == "coupled":
        from orbits.machines.coupled.machine import Coupled

        return Coupled
    raise ParameterError(f"model name = {name!r} is unknown; choose one of {', '.join(NAMES)}")


def build(settings: Mapping[str, Any]) -> Model:
    """The machine with these settings, `name` among them (see `Model.settings`)."""
    values = dict(settings)
    if values.pop("units", None):
        from orbits.machines.physical import physical

        return physical(str(values.pop("name")), values, bool(values.pop("unusual", False)))
    return model_class(str(values.pop("name")))(**values)
