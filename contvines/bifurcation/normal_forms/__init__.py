"""Normal forms at single points, from derivatives of the equations there."""
