"""Velocity graze: a sliding velocity touches zero within a flight. Its test functions are the margins that the problem calls by this name."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind(
    "velocity-graze", "VG", text="velocity graze", marker="v", filled=True, border=True, leaves="beyond"
)
