"""Names of version 0.1: the machines now live in `orbits.machines`, the scales in `orbits.design`."""
