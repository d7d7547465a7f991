"""Structures: matrices with local contacts, as machines on a page."""
