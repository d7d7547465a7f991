"""Switching: the branches that leave a branch point, and its normal form."""

from .departures import Departure, departures, null_vectors

__all__ = ["Departure", "departures", "null_vectors"]
