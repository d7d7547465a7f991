"""Pseudo-arclength continuation of one branch: one algorithm, in the native core or in Python."""
