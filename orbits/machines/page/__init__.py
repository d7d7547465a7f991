"""A declared machine of Python: equations of motion and contacts."""
