"""Block-cyclic bordered systems, solved in O(l)."""
