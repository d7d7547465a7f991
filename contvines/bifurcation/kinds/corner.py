"""Corner: events of two contacts happen at once. Its test functions are the margins that the problem calls by this name."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind("corner", "CO", text="two events at once", marker="P", filled=True, border=True, leaves="beyond")
