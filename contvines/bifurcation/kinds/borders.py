"""Borders: where a motion or an equilibrium stops being possible. Their test functions are the margins that the problem calls by these names."""

from __future__ import annotations

from ..kind import Kind


def _border(name: str, label: str, marker: str, text: str = "", filled: bool = True) -> Kind:
    return Kind(name, label, text=text, marker=marker, filled=filled, border=True, leaves="beyond")


#: borders that are met at once take the first of these names
KINDS = (
    # friction holds what has come to rest, or lets it go
    _border("stick", "ST", "<", "turn to stick"),
    # a sliding velocity touches zero within a flight
    _border("velocity-graze", "VG", "v"),
    # a wall is touched without speed
    _border("wall-graze", "WG", ">"),
    # an impact loses its speed, or a stick or flight its duration
    _border("vanishing-event", "VE", "X"),
    # the surface of a switch is touched without speed
    _border("switch-graze", "SG", "d"),
    # events of two contacts happen at once
    _border("corner", "CO", "P", "two events at once"),
    # a solution comes to the surface between two pieces of the equations
    _border("switch", "SW", "d", filled=False),
    # the period of a cycle grows without bound
    _border("homoclinic", "HC", "H", "homoclinic orbit"),
    # a motion comes to touch an event that stops it
    _border("event", "EV", "8"),
)
