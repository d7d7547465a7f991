"""The flows by the names that machines call them; one is imported when a machine asks for it."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, TypeVar

from orbits.flows.protocol import Flow

if TYPE_CHECKING:
    from orbits.machines.varying import Varying

Model = TypeVar("Model", bound="Varying")


def flow_of(model: Model) -> Flow[Model]:
    """The flow of a machine."""
    return _flow(model.flow)


@cache
def _flow(name: str) -> Flow:
    if name == "page":
        from orbits.flows.page.flow import PageFlow

        return PageFlow()
    from orbits.flows.native.flow import NativeFlow

    return NativeFlow()
