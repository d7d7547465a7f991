"""Integrators of machines on a page."""
