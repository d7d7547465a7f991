"""Event: a motion comes to touch an event that stops it. Its test functions are the margins that the problem calls by this name."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind("event", "EV", text="event", marker="8", filled=True, border=True, leaves="beyond")
