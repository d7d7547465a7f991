"""Flows of machines on a page: integrated, with the laws of their contacts."""
