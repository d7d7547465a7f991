"""Pictures of orbits; matplotlib is imported when the first picture is drawn."""
