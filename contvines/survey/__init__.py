"""Surveys: a diagram for each of many systems of one family, and outcomes (numbers) of each diagram."""

from .plan import Plan, PlanError, planned
from .results import Survey, load_survey
from .survey import survey

__all__ = ["Plan", "PlanError", "Survey", "load_survey", "planned", "survey"]
