"""Orbits in closed form, which nobody has to look for."""
