"""Cycles: identity, rounds and deviation from the simulation of periodic motions."""
