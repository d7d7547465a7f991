"""Surveys: many systems of one family, a diagram of each, and what comes out of it."""

from .plan import Plan, PlanError, planned
from .results import Survey, load_survey
from .survey import survey

__all__ = ["Plan", "PlanError", "Survey", "load_survey", "planned", "survey"]
