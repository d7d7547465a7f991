"""Approximate theory of the absorber: slow manifolds and multiple scales."""
