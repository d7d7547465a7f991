"""Pseudo-arclength continuation: one algorithm, compiled or interpreted."""
