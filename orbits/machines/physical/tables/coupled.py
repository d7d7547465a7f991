"""The coupled machine's quantities in SI units.

    eps = m/M,   lambda = c/(m omega_0),   g~ = g/(b omega_0^2),   G = E/(b eps),   Omega = 2 pi f/omega_0.

A force F sin(omega t) on the oscillator is a base that moves by F/k and pulls through the spring alone. Source: Youssef, Karoui,
Leine, the model section.
"""

from __future__ import annotations

import math

from orbits.machines.physical.quantities import Quantity, gauges
from orbits.machines.physical.tables import limits

SCALES = ("half_width", "natural_rate", "oscillator_mass")
"""b [m], omega_0 [rad/s], M [kg]."""

_TURN = 1.0 / (2.0 * math.pi)
_BASE = {"forcing": 1.0, "half_width": 1.0, "mass_ratio": 1.0}

QUANTITIES = {
    quantity.name: quantity
    for quantity in (
        Quantity("oscillator_mass", "kg", "3.8 kg", {"oscillator_mass": 1}, limits.OSCILLATOR_MASS, "the oscillator's mass"),
        Quantity("absorber_mass", "kg", "32 g", {"mass_ratio": 1, "oscillator_mass": 1}, limits.POSITIVE, "the absorber's mass", group="absorber_mass"),
        Quantity("mass_ratio", "", "0.01", {"mass_ratio": 1}, limits.SHARE, "the absorber's share of the oscillator's mass", group="absorber_mass"),
        Quantity("half_width", "m", "15 mm", {"half_width": 1}, limits.CLEARANCE, "the clearance to either side"),
        Quantity("natural_frequency", "Hz", "8 Hz", {"natural_rate": 1}, limits.NATURAL_FREQUENCY, "a natural frequency", _TURN, group="natural_frequency"),
        Quantity("stiffness", "N/m", "9600 N/m", {"oscillator_mass": 1, "natural_rate": 2}, limits.STIFFNESS, "a stiffness", group="natural_frequency"),
        Quantity("damping_ratio", "", "0.007", {"mass_ratio": 1, "damping": 1}, limits.SHARE, "a damping ratio", 0.5, group="damping", zero=True, default=0.0),
        Quantity("damping", "N s/m", "2.7 N s/m", {"mass_ratio": 1, "damping": 1, "oscillator_mass": 1, "natural_rate": 1}, limits.POSITIVE, "a damping coefficient", group="damping", zero=True),
        Quantity("restitution", "", "0.6", {"restitution": 1}, limits.RESTITUTION, "a coefficient of restitution"),
        Quantity("friction", "", "0.1", {"friction": 1}, limits.FRICTION, "a coefficient of friction", zero=True),
        Quantity("gravity", "m/s^2", "9.81 m/s^2", {"gravity": 1, "half_width": 1, "natural_rate": 2}, limits.GRAVITY, "a gravity", zero=True, default="9.81 m/s^2"),
        Quantity("base_amplitude", "m", "0.3 mm", _BASE, limits.AMPLITUDE, "the base's amplitude", group="excitation_amplitude", zero=True),
        Quantity("base_acceleration", "m/s^2", "0.8 m/s^2", _BASE | {"frequency": 2, "natural_rate": 2}, limits.ACCELERATION, "the base's acceleration", group="excitation_amplitude", zero=True),
        Quantity("force_amplitude", "N", "3 N", _BASE | {"oscillator_mass": 1, "natural_rate": 2}, limits.POSITIVE, "a force's amplitude", group="excitation_amplitude", zero=True),
        Quantity("frequency", "Hz", "8 Hz", {"frequency": 1, "natural_rate": 1}, limits.FREQUENCY, "the frequency of the excitation", _TURN),
        Quantity("excitation", "", "1", {"excitation": 1}, (0.0, 1.0), "the damper's share in the excitation", zero=True, default=1.0),
        Quantity("slope", "rad", "5 deg", {"slope": 1}, (-1.6, 1.6), "the cavity's angle", zero=True, signed=True, default="0 deg"),
    )
}  # fmt: skip

GAUGES = gauges({"mass_ratio": 1, "oscillator_mass": 1})
"""What one dimensionless unit of each kind of measure is."""


def completed(given: dict[str, float]) -> dict[str, float]:
    """The quantities [SI] with what follows from them: a force leaves the damper's share out, and the excitation is at resonance."""
    found = dict(given)
    if "force_amplitude" in given:
        found.setdefault("excitation", 0.0)
    if "natural_frequency" in given:
        found.setdefault("frequency", given["natural_frequency"])
    elif "stiffness" in given and "oscillator_mass" in given:
        found.setdefault("frequency", math.sqrt(given["stiffness"] / given["oscillator_mass"]) * _TURN)
    return found
