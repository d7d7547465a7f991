"""Event-driven simulation: exact event lists, attractors, replay of orbits, sweeps.

Every model brings its own compiled stepper (``absorber_kernels``, ``coupled_kernels``); the contract that
they share is written down in :mod:`orbits.simulation.contract`. Everything else here is model-agnostic.

Importing this package is cheap: compiled code is loaded by the first simulation.
"""

from __future__ import annotations

import importlib

_HOME = {
    "simulate": "driver",
    "Trajectory": "trajectory",
    "find_attractor": "recurrence",
    "Attractor": "attractor",
    "replay": "replaying",
    "Replay": "replaying",
    "sweep": "sweeping",
    "sweeps": "sweeping",
    "SweepRow": "sweeping",
    "find_attractors": "sweeping",
    "SimulationError": "driver",
    "replay_nodes": "replaying",
}

__all__ = sorted(_HOME)


def __getattr__(name: str):
    if name in _HOME:
        return getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
