"""Export of results to other programs: files, tables, standard JSON."""

from .files import ENDINGS, FORMATS, check_target, export, json_text

__all__ = ["ENDINGS", "FORMATS", "check_target", "export", "json_text"]
