"""The absorber's quantities in SI units: those of every shaken cavity."""

from orbits.machines.cavity.shaken_quantities import GAUGES, QUANTITIES, SCALES, completed

__all__ = ["GAUGES", "QUANTITIES", "SCALES", "completed"]
