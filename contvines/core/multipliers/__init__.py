"""Multipliers of cycles of any length: eigenvalues of a long product of small matrices, without trusting the product."""
