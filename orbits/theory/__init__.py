"""Theory beside the exact motions."""
