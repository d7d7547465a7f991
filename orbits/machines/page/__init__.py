"""A machine on a page of Python: equations of motion and contacts."""
