"""Flows of declared machines: integrated, with the laws of their contacts."""
