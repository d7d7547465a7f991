"""When multipliers from a scaled product are trusted; native/multipliers.hpp has the same number."""

CERTIFIED = 1e-10
"""Relative error of a multiplier up to which the scaled product is trusted."""
