"""Coexisting motions: attractors that many simulated starts reach, joined with branches from continuation; basins and robustness."""
