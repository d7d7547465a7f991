"""Switch graze: the surface of a switch is touched without speed. Its test functions are the margins that the problem calls by this name."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind("switch-graze", "SG", text="switch graze", marker="d", filled=True, border=True, leaves="beyond")
