"""Block-cyclic bordered systems, solved in O(l): the reference of native/elimination.hpp."""
