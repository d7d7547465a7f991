"""Branches: following one with its special points, putting its pieces together, and what comes out of it."""
