"""Declared machines: equations of motion and contacts from a machine file of Python (in the code also called a page)."""
