"""Contact laws: walls, dry friction, switches."""
