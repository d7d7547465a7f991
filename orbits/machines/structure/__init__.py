"""Structures: matrices with local contacts, as declared machines."""
