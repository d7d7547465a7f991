"""Vanishing event: an impact loses its speed, or a stick or flight its duration. Its test functions are the margins that the problem calls by this name."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind(
    "vanishing-event", "VE", text="vanishing event", marker="X", filled=True, border=True, leaves="beyond"
)
