"""The flows by the names that machines call them."""

from __future__ import annotations

from typing import Any

from orbits.flows.native.flow import NativeFlow
from orbits.flows.page.flow import PageFlow
from orbits.flows.protocol import Flow

FLOWS: dict[str, Flow] = {"native": NativeFlow(), "page": PageFlow()}


def flow_of(model: Any) -> Flow:
    """The flow of a machine."""
    return FLOWS[model.flow]
