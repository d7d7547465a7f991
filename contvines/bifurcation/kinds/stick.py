"""Turn to stick: friction holds what has come to rest, or lets it go. Its test functions are the margins that the problem calls by this name."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind("stick", "ST", text="turn to stick", marker="<", filled=True, border=True, leaves="beyond")
