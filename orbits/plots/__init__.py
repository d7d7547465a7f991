"""Pictures of orbits; matplotlib is imported by the first of them."""
