"""Quantities of the built-in machines in SI units, one table for each kind of cavity."""

PLACES = {"absorber": "shaken", "cavity": "cavity", "coupled": "coupled"}
"""The table of each machine."""
