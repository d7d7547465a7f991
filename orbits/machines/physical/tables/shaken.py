"""The shaken cavity's quantities in SI units: C = A/b, g~ = g/(b omega_0^2), Omega = 2 pi f/omega_0.

There is no oscillator in it; its natural frequency only says what Omega = 1 means and may be left out. Energies are those of the
absorber, per kilogram of it where its mass is not given.
"""

from __future__ import annotations

import math

from orbits.machines.physical.quantities import Quantity, gauges
from orbits.machines.physical.tables import limits

SCALES = ("half_width", "natural_rate", "absorber_mass")
"""b [m], omega_0 [rad/s], m [kg]."""

_TURN = 1.0 / (2.0 * math.pi)

QUANTITIES = {
    quantity.name: quantity
    for quantity in (
        Quantity("amplitude", "m", "8 mm", {"amplitude": 1, "half_width": 1}, limits.AMPLITUDE, "the amplitude of the cavity's motion", zero=True),
        Quantity("half_width", "m", "15 mm", {"half_width": 1}, limits.CLEARANCE, "the clearance to either side"),
        Quantity("frequency", "Hz", "8 Hz", {"frequency": 1, "natural_rate": 1}, limits.FREQUENCY, "the frequency of the shaking", _TURN),
        Quantity("natural_frequency", "Hz", "8 Hz", {"natural_rate": 1}, limits.NATURAL_FREQUENCY, "a natural frequency", _TURN),
        Quantity("restitution", "", "0.6", {"restitution": 1}, limits.RESTITUTION, "a coefficient of restitution"),
        Quantity("friction", "", "0.1", {"friction": 1}, limits.FRICTION, "a coefficient of friction", zero=True),
        Quantity("gravity", "m/s^2", "9.81 m/s^2", {"gravity": 1, "half_width": 1, "natural_rate": 2}, limits.GRAVITY, "a gravity", zero=True, default="9.81 m/s^2"),
        Quantity("mass_ratio", "", "0.01", {"mass_ratio": 1}, limits.SHARE, "the absorber's share of the oscillator's mass", zero=True, default=0.0, group="oscillator_mass"),
        Quantity("oscillator_mass", "kg", "3.8 kg", {"absorber_mass": 1, "mass_ratio": -1}, limits.OSCILLATOR_MASS, "the oscillator's mass", group="oscillator_mass"),
        Quantity("absorber_mass", "kg", "32 g", {"absorber_mass": 1}, limits.POSITIVE, "the absorber's mass", default="1 kg"),
    )
}  # fmt: skip

GAUGES = gauges({"absorber_mass": 1})
"""What one dimensionless unit of each kind of measure is."""


def completed(given: dict[str, float]) -> dict[str, float]:
    """The quantities [SI] with what follows from them: Omega = 1 where no natural frequency is given."""
    found = dict(given)
    if "frequency" in given:
        found.setdefault("natural_frequency", given["frequency"])
    return found
