"""Machines: one folder each, `base` with what they all offer, `catalogue` with their names."""
