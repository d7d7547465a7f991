"""The machines: one model per file."""
