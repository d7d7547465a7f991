"""Design figures of an impact absorber in physical units, for one machine or for a grid of machines.

Every field of `Design` may be an array. The fields broadcast, so one call gives a map over friction and
cavity length:

    Design(friction=mu[None, :], half_width=b[:, None]).operating_ratio

Sources: Youssef, Karoui and Leine, sections "Effect of friction on design-relevant performance metrics",
"Inactive absorber" and "Purely sliding absorber"; the lower end of pure sliding is corrected to where
sticking ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import wraps
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbits.theory import manifolds

if TYPE_CHECKING:
    from orbits.arguments import Reals

# range of half-width [m] and natural frequency [Hz] of a machine; squares and quotients do not overflow
SCALE = (1e-9, 1e9)
_AROUND = (1e-12, 1e12)  # the same range for maps, whose axes extend beyond the machine's values
_LARGEST = 1e9  # largest friction, mass ratio, damping and acceleration


class Figure(NamedTuple):
    """One line of a design table."""

    name: str
    symbol: str
    value: Reals
    unit: str
    meaning: str


@dataclass(frozen=True)
class Design:
    """A linear oscillator with an impact absorber, in SI units; by default the machine of Youssef, Karoui and Leine.

    Parameters
    ----------
    half_width : array_like
        ``b`` [m], the clearance to either side: the absorber travels ``2 b`` from wall to wall. `cavity` is an older name.
    natural_frequency : array_like
        ``f_0`` of the oscillator alone [Hz].
    restitution : array_like
        ``r``, in (0, 1].
    friction : array_like
        Coefficient of dry friction ``mu``.
    mass_ratio : array_like
        ``eps = m/M``. The bounds are those of the exact maps (``h~ = (1 + eps) h``); 0 gives the physical
        formulas of the paper, which neglect it.
    damping : array_like
        ``lambda = c/(m omega_0)``; the oscillator's damping ratio is ``eps lambda/2``.
    acceleration : array_like
        Gravity ``g`` [m/s^2].

    Raises
    ------
    ValueError
        If a value has no physical meaning; the message names the field.
    """

    half_width: Reals = 0.02
    natural_frequency: Reals = 7.666
    restitution: Reals = 0.76
    friction: Reals = 0.5
    mass_ratio: Reals = 0.006
    damping: Reals = 0.9
    acceleration: Reals = 9.81

    def __post_init__(self) -> None:
        def scale(x: NDArray) -> NDArray:
            return (x >= _AROUND[0]) & (x <= _AROUND[1])

        def size(x: NDArray) -> NDArray:
            return (x >= 0) & (x <= _LARGEST)

        rules = {
            "half_width": (scale, "must be positive, from 1e-12 to 1e12 [m]"),
            "natural_frequency": (scale, "must be positive, from 1e-12 to 1e12 [Hz]"),
            "restitution": (lambda x: (x > 0) & (x <= 1), "must lie in (0, 1]"),
            "friction": (size, "must lie between 0 and 1e9"),
            "mass_ratio": (size, "must lie between 0 and 1e9"),
            "damping": (size, "must lie between 0 and 1e9"),
            "acceleration": (size, "must lie between 0 and 1e9 [m/s^2]"),
        }
        for name, (holds, rule) in rules.items():
            value = np.asarray(getattr(self, name), dtype=float)
            fine = holds(value) & np.isfinite(value)
            if not np.all(fine):
                raise ValueError(f"{name} = {value[~fine].flat[0]} {rule}.")
            object.__setattr__(self, name, float(value) if value.ndim == 0 else value)

    @classmethod
    def from_dimensionless(
        cls,
        *,
        gravity: float,
        half_width: float | None = None,
        natural_frequency: float | None = None,
        cavity: float | None = None,
        **fields: Reals,
    ) -> Design:
        """Make a design from ``g~ = g/(b omega_0^2)`` and either the half-width or the natural frequency; the other one follows.

        Parameters
        ----------
        gravity : float
            ``g~``, above 0.
        half_width, natural_frequency : float, optional
            Exactly one of them, in m or Hz. `cavity` is an older name of `half_width`.
        **fields
            The other fields of `Design`.

        Raises
        ------
        ValueError
            If both scales or none are given, ``gravity`` is not positive, or a scale lies outside `SCALE`.
        """
        if half_width is not None and cavity is not None:
            raise ValueError("half_width and cavity say the same thing twice; leave cavity out.")
        width = "half_width" if cavity is None else "cavity"  # the name that the user wrote, for messages
        cavity = half_width if cavity is None else cavity
        if (cavity is None) == (natural_frequency is None):
            raise ValueError(
                "give exactly one of half_width [m] and natural_frequency [Hz]; gravity fixes the other."
            )
        if not gravity > 0:
            raise ValueError(f"gravity = {gravity} must be positive to fix a scale.")
        name, unit = ("natural_frequency", "Hz") if cavity is None else (width, "m")
        value = float(natural_frequency if cavity is None else cavity)  # type: ignore[arg-type]
        if not SCALE[0] <= value <= SCALE[1]:
            raise ValueError(
                f"{name} = {value!r} must be positive, from {SCALE[0]:g} to {SCALE[1]:g} [{unit}]."
            )
        g = float(fields.get("acceleration", cls.acceleration))
        with np.errstate(over="ignore"):
            if cavity is None:
                cavity = other = g / (float(gravity) * (2.0 * np.pi * value) ** 2)
            else:
                natural_frequency = other = float(np.sqrt(np.float64(g) / gravity / cavity) / (2.0 * np.pi))
        if not SCALE[0] <= other <= SCALE[1]:
            follows = (
                "half_width = {:.6g} m" if name == "natural_frequency" else "natural_frequency = {:.6g} Hz"
            )
            raise ValueError(
                f"gravity = {gravity!r} with {name} = {value!r} {unit} means {follows.format(other)}, which lies outside "
                f"{SCALE[0]:g} to {SCALE[1]:g}; change one of the two."
            )
        frequency = value if natural_frequency is None else natural_frequency
        return cls(half_width=cavity, natural_frequency=frequency, **fields)

    def with_(self, **changes: Reals) -> Design:
        """A copy with some fields changed."""
        if "cavity" in changes:
            changes["half_width"] = changes.pop("cavity")
        return replace(self, **changes)

    @property
    def cavity(self) -> Reals:
        """`half_width`, by its older name."""
        return self.half_width

    @property
    def natural_rate(self) -> Reals:
        """``omega_0`` [rad/s]."""
        return 2.0 * np.pi * self.natural_frequency

    @property
    def gravity(self) -> Reals:
        """``g~ = g/(b omega_0^2)``, dimensionless."""
        return self.acceleration / (self.half_width * self.natural_rate**2)

    @property
    def loss(self) -> Reals:
        """``R = (1 - r)/(1 + r)``."""
        return manifolds.impact_loss(self.restitution)

    @property
    def level(self) -> Reals:
        """``h~ = (1 + eps)(pi/2) mu g~``, dimensionless."""
        return manifolds.friction_level(self.friction, self.gravity, self.mass_ratio)

    @property
    def activation_threshold(self) -> Reals:
        """``q1_min = b C_min`` [m]: displacement of the oscillator at which the absorber engages."""
        return self.half_width * manifolds.activation(self.loss, self.level).amplitude

    @property
    def upper_bound(self) -> Reals:
        """``q1_max = b C_max`` [m]: displacement above which two symmetric impacts per period are
        unstable."""
        return self.half_width * manifolds.symmetry_limit(self.loss, self.level).amplitude

    @property
    def operating_ratio(self) -> Reals:
        """``xi = q1_max/q1_min``: width of the working range; inf for elastic walls without friction, where the threshold is 0."""
        with np.errstate(divide="ignore"):
            return self.upper_bound / self.activation_threshold

    def sticking_limit(self, frequency: ArrayLike | None = None) -> Reals:
        """``q1_cr = mu g/omega^2`` [m] at an excitation frequency [Hz] (default ``f_0``): below it the
        absorber sticks.

        Exact: oscillator and absorber then move as one, and the friction force needed is ``m omega^2 q_1``.
        """
        f = self.natural_frequency if frequency is None else np.asarray(frequency, dtype=float)
        return self.friction * self.acceleration / (2.0 * np.pi * f) ** 2

    @property
    def sliding_bounds(self) -> tuple[Reals, Reals]:
        """`sliding_bounds_at` the natural frequency."""
        return self.sliding_bounds_at()

    def sliding_bounds_at(self, frequency: ArrayLike | None = None) -> tuple[Reals, Reals]:
        """Displacements [m] of the oscillator between which the absorber slides, without sticking or impacts, at an
        excitation frequency [Hz] (default ``f_0``).

        The bounds are ``b/(1 + eps)`` times the bounds of ``C``, with ``h/Omega^2`` in place of ``h``, because the force of inertia
        grows with the square of the frequency. The lower value of the paper, ``b h/(1 + eps)``, is too low: there the absorber
        still sticks at every turn.
        """
        ratio = 1.0 if frequency is None else np.asarray(frequency, dtype=float) / self.natural_frequency
        low, high = manifolds.sliding_bounds(self.level / ratio**2)
        scale = self.half_width / (1.0 + np.asarray(self.mass_ratio))
        return scale * low, scale * high

    @property
    def absorber_damping(self) -> Reals:
        """``eps (2/pi) R/(pi^2/4 + R^2)``: damping ratio that the impacts add to the oscillator at large
        amplitude."""
        return self.mass_ratio * (2.0 / np.pi) * self.loss / (0.25 * np.pi**2 + self.loss**2)

    def linear_response(self, frequency: ArrayLike, excitation: ArrayLike, *, stuck: bool = False) -> Reals:
        """Displacement amplitude [m] of the oscillator under a base motion ``E sin(omega t)``.

        Parameters
        ----------
        frequency : array_like
            Excitation frequency [Hz].
        excitation : array_like
            ``E`` [m].
        stuck : bool
            If True, the absorber sticks to the cavity (mass ``M + m``); else the oscillator has no absorber.
        """
        ratio = np.asarray(frequency, dtype=float) / self.natural_frequency
        path = 1.0 + 1j * np.asarray(self.mass_ratio) * np.asarray(self.damping) * ratio
        mass = 1.0 + np.asarray(self.mass_ratio) * stuck
        return np.asarray(excitation, dtype=float) * np.abs(path / (path - mass * ratio**2))

    def excitation(self, forcing: ArrayLike) -> Reals:
        """Base amplitude ``E = G b eps`` [m] of a dimensionless forcing ``G``."""
        return np.asarray(forcing, dtype=float) * self.half_width * self.mass_ratio

    def is_stuck(self, frequency: ArrayLike, excitation: ArrayLike) -> NDArray[np.bool_]:
        """Whether friction can hold the absorber in the linear response with a stuck absorber."""
        return np.less_equal(
            self.linear_response(frequency, excitation, stuck=True), self.sticking_limit(frequency)
        )

    def figures(self) -> list[Figure]:
        """All design figures with symbol, unit and meaning."""
        low, high = self.sliding_bounds
        return [
            Figure("activation threshold", "q1_min", self.activation_threshold, "m", "the absorber engages"),
            Figure("upper bound", "q1_max", self.upper_bound, "m", "end of symmetric impacts"),
            Figure("operating ratio", "xi", self.operating_ratio, "1", "q1_max/q1_min"),
            Figure("sticking limit, f_0", "q1_cr", self.sticking_limit(), "m", "below: stuck"),
            Figure("pure sliding from, f_0", "q1_sl_min", low, "m", "below: stick at each turn"),
            Figure("pure sliding to, f_0", "q1_sl_max", high, "m", "above: impacts"),
            Figure("damping by impacts", "D_NES", self.absorber_damping, "1", "ratio, large amplitude"),
            Figure("oscillator's damping", "D", 0.5 * self.mass_ratio * self.damping, "1", "ratio, no absorber"),
            Figure("friction level", "h", self.level, "1", "(1+eps)(pi/2) mu g~"),
            Figure("impact loss", "R", self.loss, "1", "(1 - r)/(1 + r)"),
        ]  # fmt: skip


def _older_name(init: Callable[..., None]) -> Callable[..., None]:
    """Wrap the constructor so that it accepts `cavity` as the older name of `half_width`."""

    @wraps(init)
    def renamed(self: Design, *values: Reals, **fields: Reals) -> None:
        if "cavity" not in fields:
            return init(self, *values, **fields)
        if "half_width" in fields:
            raise ValueError("half_width and cavity say the same thing twice; leave cavity out.")
        fields["half_width"] = fields.pop("cavity")
        try:
            init(self, *values, **fields)
        except ValueError as error:  # the message uses the name that the user wrote
            raise ValueError(str(error).replace("half_width", "cavity", 1)) from None

    return renamed


Design.__init__ = _older_name(Design.__init__)
