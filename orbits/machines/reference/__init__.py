"""The native core once more in Python and numpy: what it is compared with, and what computes where it cannot be loaded."""
