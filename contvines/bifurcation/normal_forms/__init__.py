"""Normal forms at special points, from derivatives of the equations there."""
