"""Graphs as files that other programs read."""

from .formats import FORMATS, check_target, export, json_text

__all__ = ["FORMATS", "check_target", "export", "json_text"]
