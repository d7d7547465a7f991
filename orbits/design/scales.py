"""Conversion between SI units and the dimensionless coupled machine.

The unit of length is the half-width b of the cavity, the unit of time 1/omega_0 with omega_0 = sqrt(k/M):

    eps = m/M,   lambda = c/(m omega_0),   g~ = g/(b omega_0^2),   G = E/(b eps),   Omega = 2 pi f/omega_0.

Source: Youssef, Karoui, Leine, the model section.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

from orbits.machines.coupled import Coupled
from orbits.machines.parameters import NOT_NEGATIVE, POSITIVE, Limits, ParameterError
from orbits.settings import DESIGNING

STANDARD_GRAVITY = 9.81


@dataclass(frozen=True, kw_only=True)
class Scales:
    """A machine in SI units.

    Parameters
    ----------
    oscillator_mass, absorber_mass : float
        M and m in kg, above 0.
    half_width : float
        b in m, above 0: from the middle of the cavity to either wall, counted to the absorber's faces.
    stiffness : float, optional
        k in N/m, above 0.
    natural_frequency : float, optional
        omega_0/(2 pi) in Hz, above 0, of the oscillator without the absorber; instead of `stiffness`, or in agreement with it.
    damping : float
        c in N s/m, 0 or above.
    friction, restitution : float
        mu >= 0 and 0 < r <= 1.
    gravity : float
        g in m/s^2, 0 or above.
    base_amplitude : float, optional
        E in m, 0 or above.

    Raises
    ------
    ParameterError
        If a value is out of range, or values contradict each other; the message names the field, the value and a way out.
    """

    oscillator_mass: float
    absorber_mass: float
    half_width: float
    stiffness: float | None = None
    natural_frequency: float | None = None
    damping: float = 0.0
    friction: float = 0.0
    restitution: float = 1.0
    gravity: float = STANDARD_GRAVITY
    base_amplitude: float | None = None

    def __post_init__(self) -> None:
        for name, unit in (("oscillator_mass", "kg"), ("absorber_mass", "kg"), ("half_width", "m")):
            _checked(name, getattr(self, name), unit)
        for name, unit in (("damping", "N s/m"), ("friction", ""), ("gravity", "m/s^2")):
            _checked(name, getattr(self, name), unit, NOT_NEGATIVE)
        if self.base_amplitude is not None:
            _checked("base_amplitude", self.base_amplitude, "m", NOT_NEGATIVE)
        if self.stiffness is None and self.natural_frequency is None:
            raise ParameterError(
                "neither stiffness nor natural_frequency is given: give one of them, in N/m or Hz"
            )
        if self.stiffness is not None and _checked("stiffness", self.stiffness, "N/m", Limits()) <= 0.0:
            raise ParameterError(
                f"stiffness = {self.stiffness:g} N/m leaves the oscillator without a natural frequency: give a "
                "stiffness above 0"
            )
        if self.natural_frequency is not None:
            _checked("natural_frequency", self.natural_frequency, "Hz")
        if self.stiffness is None:
            assert self.natural_frequency is not None
            omega = 2.0 * math.pi * self.natural_frequency
            object.__setattr__(self, "stiffness", self.oscillator_mass * omega**2)
        elif self.natural_frequency is None:
            object.__setattr__(self, "natural_frequency", self.omega_0 / (2.0 * math.pi))
        else:
            follows = self.omega_0 / (2.0 * math.pi)
            if abs(follows - self.natural_frequency) > DESIGNING.agreement * follows:
                raise ParameterError(
                    f"natural_frequency = {self.natural_frequency:g} Hz contradicts stiffness = {self.stiffness:g} N/m with "
                    f"oscillator_mass = {self.oscillator_mass:g} kg, which give {follows:.6g} Hz: leave one of them out"
                )
        self.machine()

    @property
    def omega_0(self) -> float:
        """sqrt(k/M) in rad/s."""
        assert self.stiffness is not None
        return math.sqrt(self.stiffness / self.oscillator_mass)

    @property
    def mass_ratio(self) -> float:
        """eps = m/M."""
        return self.absorber_mass / self.oscillator_mass

    # ------------------------------------------------------------------ SI -> dimensionless
    def frequency(self, hertz: float) -> float:
        """Return Omega for a frequency in Hz.

        Raises
        ------
        ParameterError
            If it is not above 0.
        """
        return 2.0 * math.pi * _checked("frequency", hertz, "Hz") / self.omega_0

    def detuning(self, hertz: float) -> float:
        """Return sigma = (Omega - 1)/eps for a frequency in Hz."""
        return (self.frequency(hertz) - 1.0) / self.mass_ratio

    def forcing(self, base_amplitude: float) -> float:
        """Return G for a base amplitude in m."""
        return _checked("base_amplitude", base_amplitude, "m", NOT_NEGATIVE) / (
            self.half_width * self.mass_ratio
        )

    def machine(
        self,
        hertz: float | None = None,
        base_amplitude: float | None = None,
        excitation: str | float = "exact",
    ) -> Coupled:
        """Return the dimensionless machine.

        Parameters
        ----------
        hertz : float, optional
            Excitation frequency in Hz; default: the natural frequency.
        base_amplitude : float, optional
            E in m; default: that of the scales. If neither is given, the machine has no value of the forcing.
        excitation : {"exact", "truncated"} or float
            See `Coupled`.

        Raises
        ------
        ParameterError
            If the machine is impossible, for example at resonance without damping.
        """
        E = self.base_amplitude if base_amplitude is None else base_amplitude
        machine = Coupled(
            restitution=self.restitution,
            friction=self.friction,
            gravity=self.gravity / (self.half_width * self.omega_0**2),
            mass_ratio=self.mass_ratio,
            damping=self.damping / (self.absorber_mass * self.omega_0),
            forcing=None if E is None else self.forcing(E),
            frequency=1.0 if hertz is None else self.frequency(hertz),
            excitation=excitation,
        )
        if hertz is not None and E is not None:
            machine.vector()
        return machine

    # ------------------------------------------------------------------ dimensionless -> SI
    def hertz(self, frequency: float) -> float:
        """Return the frequency in Hz for Omega."""
        return frequency * self.omega_0 / (2.0 * math.pi)

    def metres(self, length: float) -> float:
        """Convert a dimensionless length to m."""
        return length * self.half_width

    def metres_per_second(self, velocity: float) -> float:
        """Convert a dimensionless velocity to m/s."""
        return velocity * self.half_width * self.omega_0

    def seconds(self, tau: float) -> float:
        """Convert a dimensionless time to s."""
        return tau / self.omega_0

    def joules(self, energy: float) -> float:
        """Convert an energy in units of m b^2 omega_0^2 (the unit of the measures) to J."""
        return energy * self.absorber_mass * (self.half_width * self.omega_0) ** 2

    @classmethod
    def of(
        cls,
        machine: Coupled,
        *,
        oscillator_mass: float,
        half_width: float | None = None,
        natural_frequency: float | None = None,
        gravity: float = STANDARD_GRAVITY,
    ) -> Self:
        """Return SI data of a dimensionless machine.

        The machine's g~ = g/(b omega_0^2) relates half-width, natural frequency and gravity: one of the first two is enough; two
        must agree with g~.

        Parameters
        ----------
        machine : Coupled
        oscillator_mass : float
            M in kg.
        half_width, natural_frequency : float, optional
            In m and Hz.
        gravity : float
            g in m/s^2.

        Raises
        ------
        ParameterError
            If the data do not determine the scales, or contradict each other.
        """
        _checked("oscillator_mass", oscillator_mass, "kg")
        for name, value, unit in (
            ("half_width", half_width, "m"),
            ("natural_frequency", natural_frequency, "Hz"),
        ):
            if value is not None:
                _checked(name, value, unit)
        if half_width is None or natural_frequency is None:
            if machine.gravity == 0.0 or gravity == 0.0 or (half_width is None and natural_frequency is None):
                raise ParameterError(
                    f"half_width = {half_width} and natural_frequency = {natural_frequency} do not fix the scales of a machine "
                    f"with gravity = {machine.gravity:g}: give "
                    + ("one of them" if machine.gravity and gravity else "both of them")
                )
            if half_width is None:
                assert natural_frequency is not None
                half_width = gravity / (machine.gravity * (2.0 * math.pi * natural_frequency) ** 2)
            else:
                natural_frequency = math.sqrt(gravity / (machine.gravity * half_width)) / (2.0 * math.pi)
        omega = 2.0 * math.pi * natural_frequency
        follows = gravity / (half_width * omega**2)
        if abs(follows - machine.gravity) > DESIGNING.agreement * max(follows, machine.gravity):
            raise ParameterError(
                f"half_width = {half_width:g} m and natural_frequency = {natural_frequency:g} Hz contradict the machine's "
                f"gravity = {machine.gravity:g}: with g = {gravity:g} m/s^2 they give {follows:.6g}; leave one of them out"
            )
        absorber_mass = machine.mass_ratio * oscillator_mass
        return cls(
            oscillator_mass=oscillator_mass,
            absorber_mass=absorber_mass,
            half_width=half_width,
            natural_frequency=natural_frequency,
            damping=machine.damping * absorber_mass * omega,
            friction=machine.friction,
            restitution=machine.restitution,
            gravity=gravity,
            base_amplitude=None
            if machine.forcing is None
            else machine.forcing * half_width * machine.mass_ratio,
        )


def _checked(name: str, value: object, unit: str, limits: Limits = POSITIVE) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ParameterError(f"{name} = {value!r} is no finite number; give one")
    if value not in limits:
        text = f"{value:g} {unit}".rstrip()
        raise ParameterError(f"{name} = {text} is out of range; give a number {limits.text}")
    return float(value)
