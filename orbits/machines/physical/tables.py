"""Quantities of the built-in machines in SI units, their usual ranges, and checks of their combinations.

Shaken cavities (`absorber`, `cavity`): C = A/b, g~ = g/(b omega_0^2), Omega = 2 pi f/omega_0. They have no oscillator; the natural frequency
only defines Omega = 1 and may be left out. Energies are those of the absorber, per kilogram if its mass is not given. For a cavity with
different walls `restitution` and `friction` are those of both sides, and each side has names of its own; distances of the walls are in
half-widths, so that the half-width scales the whole cavity.

The coupled machine: eps = m/M, lambda = c/(m omega_0), g~ = g/(b omega_0^2), G = E/(b eps), Omega = 2 pi f/omega_0. A force F sin(omega t)
on the oscillator is equivalent to a base that moves by F/k and acts through the spring alone. Source: Youssef, Karoui, Leine, the model
section.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from orbits.machines.physical.quantities import Quantity, QuantityError, gauges

# usual ranges; values outside need `unusual`
_AMPLITUDE = (1e-9, 10.0)
_FREQUENCY = (0.001, 100_000.0)
_SHARE = (1e-6, 0.5)  # of the oscillator's mass, or of critical damping
_OSCILLATOR_MASS = (1e-6, 1e9)
_POSITIVE = (1e-9, 1e9)  # of an absorber's mass, a damping coefficient and a force
_RATIO = (0.001, 1000.0)  # of one wall's number to the other's, or of its distance to the half-width

_TURN = 1.0 / (2.0 * math.pi)


@dataclass(frozen=True)
class Table:
    """The quantities of one machine.

    Attributes
    ----------
    quantities : dict of str to Quantity
        By name.
    scales : tuple of str
        b [m], omega_0 [rad/s] and a mass [kg].
    gauges : dict of str to Quantity
        One dimensionless unit of each kind of measure.
    completed : callable
        Given quantities [SI] -> the same with those that follow; raises `QuantityError` if they contradict one another.
    """

    quantities: dict[str, Quantity]
    scales: tuple[str, ...]
    gauges: dict[str, Quantity]
    completed: Callable[[dict[str, float]], dict[str, float]]


def _by_name(*quantities: Quantity) -> dict[str, Quantity]:
    return {quantity.name: quantity for quantity in quantities}


# fmt: off
_HALF_WIDTH = Quantity("half_width", "m", "15 mm", {"half_width": 1}, (1e-5, 2.0), "the clearance to either side")
_NATURAL_FREQUENCY = Quantity("natural_frequency", "Hz", "8 Hz", {"natural_rate": 1}, (0.01, 100_000.0), "a natural frequency", _TURN)
_RESTITUTION = Quantity("restitution", "", "0.6", {"restitution": 1}, (0.01, 1.0), "a coefficient of restitution")
_FRICTION = Quantity("friction", "", "0.1", {"friction": 1}, (1e-6, 2.0), "a coefficient of friction", zero=True)
_GRAVITY = Quantity("gravity", "m/s^2", "9.81 m/s^2", {"gravity": 1, "half_width": 1, "natural_rate": 2}, (1e-6, 500.0), "a gravity", zero=True, default="9.81 m/s^2")
_SLOPE = Quantity("slope", "rad", "5 deg", {"slope": 1}, (-1.6, 1.6), "the cavity's angle", zero=True, signed=True, default="0 deg")

_SHAKEN = _by_name(
    Quantity("amplitude", "m", "8 mm", {"amplitude": 1, "half_width": 1}, _AMPLITUDE, "the amplitude of the cavity's motion", zero=True),
    _HALF_WIDTH,
    Quantity("frequency", "Hz", "8 Hz", {"frequency": 1, "natural_rate": 1}, _FREQUENCY, "the frequency of the shaking", _TURN),
    _NATURAL_FREQUENCY,
    _RESTITUTION,
    _FRICTION,
    _GRAVITY,
    Quantity("mass_ratio", "", "0.01", {"mass_ratio": 1}, _SHARE, "the absorber's share of the oscillator's mass", zero=True, default=0.0, group="oscillator_mass"),
    Quantity("oscillator_mass", "kg", "3.8 kg", {"absorber_mass": 1, "mass_ratio": -1}, _OSCILLATOR_MASS, "the oscillator's mass", group="oscillator_mass"),
    Quantity("absorber_mass", "kg", "32 g", {"absorber_mass": 1}, _POSITIVE, "the absorber's mass", default="1 kg"),
)
_SIDES = {"restitution": _RESTITUTION, "friction": _FRICTION}


def _of_sides(shared: Quantity) -> tuple[Quantity, ...]:
    """Return a quantity for both sides and the ratio right over left, or one quantity for each side."""
    name, (left, right) = shared.name, (f"{shared.name}_left", f"{shared.name}_right")
    one, other = replace(shared, powers={left: 1}, group=left), replace(shared, powers={right: 1}, group=right)
    ratio = Quantity(f"{right}_over_left", "", "1", {right: 1, left: -1}, _RATIO, f"the ratio of the sides' {name}", group=right, default=1.0)
    return one, replace(one, name=left), ratio, replace(other, name=right)


_CAVITY = {
    **{name: quantity for name, quantity in _SHAKEN.items() if name not in _SIDES},
    **_by_name(
        *_of_sides(_RESTITUTION),
        *_of_sides(_FRICTION),
        _SLOPE,
        Quantity("distance_left", "", "1", {"distance_left": 1}, _RATIO, "the left wall's distance in half-widths", default=1.0),
        Quantity("distance_right", "", "1", {"distance_right": 1}, _RATIO, "the right wall's distance in half-widths", default=1.0),
    ),
}

_BASE = {"forcing": 1.0, "half_width": 1.0, "mass_ratio": 1.0}
_COUPLED = _by_name(
    Quantity("oscillator_mass", "kg", "3.8 kg", {"oscillator_mass": 1}, _OSCILLATOR_MASS, "the oscillator's mass"),
    Quantity("absorber_mass", "kg", "32 g", {"mass_ratio": 1, "oscillator_mass": 1}, _POSITIVE, "the absorber's mass", group="absorber_mass"),
    Quantity("mass_ratio", "", "0.01", {"mass_ratio": 1}, _SHARE, "the absorber's share of the oscillator's mass", group="absorber_mass"),
    _HALF_WIDTH,
    _NATURAL_FREQUENCY,
    Quantity("stiffness", "N/m", "9600 N/m", {"oscillator_mass": 1, "natural_rate": 2}, (1e-4, 1e13), "a stiffness", group="natural_frequency"),
    Quantity("damping_ratio", "", "0.007", {"mass_ratio": 1, "damping": 1}, _SHARE, "a damping ratio", 0.5, group="damping", zero=True, default=0.0),
    Quantity("damping", "N s/m", "2.7 N s/m", {"mass_ratio": 1, "damping": 1, "oscillator_mass": 1, "natural_rate": 1}, _POSITIVE, "a damping coefficient", group="damping", zero=True),
    _RESTITUTION,
    _FRICTION,
    _GRAVITY,
    Quantity("base_amplitude", "m", "0.3 mm", _BASE, _AMPLITUDE, "the base's amplitude", group="excitation_amplitude", zero=True),
    Quantity("base_acceleration", "m/s^2", "0.8 m/s^2", _BASE | {"frequency": 2, "natural_rate": 2}, (1e-9, 100_000.0), "the base's acceleration", group="excitation_amplitude", zero=True),
    Quantity("force_amplitude", "N", "3 N", _BASE | {"oscillator_mass": 1, "natural_rate": 2}, _POSITIVE, "a force's amplitude", group="excitation_amplitude", zero=True),
    Quantity("frequency", "Hz", "8 Hz", {"frequency": 1, "natural_rate": 1}, _FREQUENCY, "the frequency of the excitation", _TURN),
    Quantity("excitation", "", "1", {"excitation": 1}, (0.0, 1.0), "the damper's share in the excitation", zero=True, default=1.0),
    _SLOPE,
)
# fmt: on


def _shaken(given: dict[str, float]) -> dict[str, float]:
    """Set Omega = 1 if no natural frequency is given."""
    return {"natural_frequency": given["frequency"], **given} if "frequency" in given else given


def _cavity(given: dict[str, float]) -> dict[str, float]:
    """Check that a quantity is given either for both sides together or for each side."""
    for name in _SIDES:
        left, right, ratio = f"{name}_left", f"{name}_right", f"{name}_right_over_left"
        if name in given and right in given:
            raise QuantityError(
                f"{name} and {right} are both given: give {name} for both sides, or {left} and {right}"
            )
        if (left in given) != (right in given) and ratio not in given:
            missing = right if left in given else left
            raise QuantityError(f"{missing} is missing: give {name} for both sides, or {left} and {right}")
    return _shaken(given)


def _coupled(given: dict[str, float]) -> dict[str, float]:
    """With a force, leave out the damper's share; without a frequency, excite at resonance."""
    found = dict(given)
    if "force_amplitude" in given:
        found.setdefault("excitation", 0.0)
    if "natural_frequency" in given:
        found.setdefault("frequency", given["natural_frequency"])
    elif "stiffness" in given and "oscillator_mass" in given:
        found.setdefault("frequency", math.sqrt(given["stiffness"] / given["oscillator_mass"]) * _TURN)
    return found


_ABSORBER_SCALES, _ABSORBER_GAUGES = (
    ("half_width", "natural_rate", "absorber_mass"),
    gauges({"absorber_mass": 1}),
)
TABLES = {
    "absorber": Table(_SHAKEN, _ABSORBER_SCALES, _ABSORBER_GAUGES, _shaken),
    "cavity": Table(_CAVITY, _ABSORBER_SCALES, _ABSORBER_GAUGES, _cavity),
    "coupled": Table(
        _COUPLED,
        ("half_width", "natural_rate", "oscillator_mass"),
        gauges({"mass_ratio": 1, "oscillator_mass": 1}),
        _coupled,
    ),
}
"""The table of each machine."""

# ------------------------------------------------------------------ quantities that do not go together
HEAVY, LIGHT = 0.5, 1e-5  # plausible range of an absorber's mass over the oscillator's
FAST = 50.0  # largest plausible ratio of excitation and natural frequency; beyond it a unit is probably wrong
FASTEST = 500.0  # the same for ends of intervals
STRONG = 20.0  # largest plausible motion of a base, in half-widths


def check_ratios(numbers: Mapping[str, float], given: Mapping[str, str], wide: bool = False) -> None:
    """Check that quantities are plausible together.

    Parameters
    ----------
    numbers : mapping
        The machine's dimensionless numbers.
    given : mapping
        The quantities as they were given.
    wide : bool
        Whether they are ends of an interval, for which wider limits hold.

    Raises
    ------
    QuantityError
    """
    ratio = numbers.get("mass_ratio", 0.0)
    if ratio > HEAVY or (0.0 < ratio < LIGHT and "absorber_mass" in given):
        rule = f"at most {HEAVY}" if ratio > HEAVY else f"at least {LIGHT:g}"
        raise QuantityError(
            f"absorber_mass{_given(given, 'absorber_mass')} is {ratio:.3g} times oscillator_mass{_given(given, 'oscillator_mass')}, "
            f"which is implausible for an absorber: expected {rule} times; if it is meant, say unusual = true in [model]"
        )
    pace = numbers.get("frequency", 1.0)
    fast = FASTEST if wide else FAST
    if "natural_frequency" in given and not 1.0 / fast <= pace <= fast:
        raise QuantityError(
            f"frequency{_given(given, 'frequency')} is {pace:.3g} times natural_frequency{_given(given, 'natural_frequency')}, which is "
            f"implausible: expected {1.0 / fast:g} to {fast:g} times; if it is meant, say unusual = true in [model]"
        )
    moved = numbers.get("forcing", 0.0) * ratio  # of the base, in half-widths
    if "base_amplitude" in given and moved > STRONG:
        raise QuantityError(
            f"base_amplitude{_given(given, 'base_amplitude')} is {moved:.3g} times half_width{_given(given, 'half_width')}, which is "
            f"implausible: expected at most {STRONG:g} times; if it is meant, say unusual = true in [model]"
        )


def _given(given: Mapping[str, str], name: str) -> str:
    return f" = {given[name]}" if name in given else ""
