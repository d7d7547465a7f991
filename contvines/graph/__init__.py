"""The graph of branches and switches."""

from .graph import Graph, Switch

__all__ = ["Graph", "Switch"]
