"""Switch: a solution comes to the surface between two pieces of the equations. Its test functions are the margins that the problem calls by this name."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind("switch", "SW", text="switch", marker="d", filled=False, border=True, leaves="beyond")
