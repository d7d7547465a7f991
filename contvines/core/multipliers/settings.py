"""When multipliers from a scaled product are trusted; native/multipliers.hpp has the same numbers."""

CERTIFIED = 1e-10
"""Relative error of a multiplier up to which the scaled product is trusted."""
EXCESS = 50.0
"""Also trusted: a bound that exceeds the effect of rounding the factors themselves by less than this, ..."""
PASSABLE = 1e-7
"""... and a relative error up to this."""
STILL = 1e-15
"""Angle by which the vector of a power iteration turns where it has converged."""
SETTLED = 1e-13
"""The same where it does not become smaller any more."""
