"""General numerics, independent of machines: the native core (compiled C++) and its reference implementation in numpy."""
