"""Built-in machines given in kilograms, millimetres and hertz."""

from orbits.machines.physical.machine import physical
from orbits.machines.physical.quantities import QuantityError

__all__ = ["QuantityError", "physical"]
