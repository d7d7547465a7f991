"""Flows of the built-in machines: closed forms in the native core, or their reference in numpy."""
