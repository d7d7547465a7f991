"""Cycles of smooth flows: differential equations, their cycles by orthogonal collocation, and the bifurcations of these."""

from __future__ import annotations

from .problem import FlowProblem

__all__ = ["FlowProblem"]
