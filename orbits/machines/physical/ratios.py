"""Quantities that do not go together: where one of them is far from what the others say there is a slip in its unit, or two are swapped."""

from __future__ import annotations

from collections.abc import Mapping

from orbits.machines.physical.quantities import QuantityError

HEAVY, LIGHT = 0.5, 1e-5  # shares of the oscillator's mass beyond which an absorber is none
FAST = 50.0  # ratio of the excitation's frequency to the natural one, or of that to it, beyond which one of them is a slip of the unit
FASTEST = 500.0  # the same for ends of intervals, which may reach far
STRONG = 20.0  # half-widths beyond which a base does not move


def check_ratios(numbers: Mapping[str, float], given: Mapping[str, str], wide: bool = False) -> None:
    """Refuse quantities that do not go together.

    Parameters
    ----------
    numbers : mapping
        The machine's own.
    given : mapping
        How the quantities were given.
    wide : bool
        Of the ends of an interval.

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
