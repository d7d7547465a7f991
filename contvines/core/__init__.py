"""General numerics that know no machine: the native core and its reference in numpy."""
