"""Helpers for both `orbits` and `contvines` that depend on neither: figures in one style, hints in error messages, worker processes, files."""
