"""Wall graze: a wall is touched without speed. Its test functions are the margins that the problem calls by this name."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind("wall-graze", "WG", text="wall graze", marker=">", filled=True, border=True, leaves="beyond")
