"""Homoclinic orbit: the period of a cycle grows without bound. Its test functions are the margins that the problem calls by this name."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind(
    "homoclinic", "HC", text="homoclinic orbit", marker="H", filled=True, border=True, leaves="beyond"
)
