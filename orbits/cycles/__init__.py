"""Cycles: margins, measures, identity and sampling of periodic motions."""
