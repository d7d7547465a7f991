"""Classification of Hopf and Neimark-Sacker points by the first Lyapunov coefficient."""

from __future__ import annotations

from typing import Any

import numpy as np

from .kind import Classified
from .normal_forms.criticality import pair_form, strong_resonance
from .point_on_branch import PointOnBranch


def classify(point: PointOnBranch) -> Classified:
    """From derivatives of the equations; of cycles on a mesh, whose unknowns are more than the states of a map, from the problem's own form."""
    problem = point.problem
    if point.engine.adaptive and problem.spectrum == "map":
        return _of_cycle(problem, point)
    if problem.spectrum not in ("map", "flow"):
        return Classified()
    form = pair_form(problem, point.u, point.value, point.engine.spectrum(point.solved.row))
    return Classified(form.criticality, form.coefficient, (form.note,) if form.note else ())


def _of_cycle(problem: Any, point: PointOnBranch) -> Classified:
    upper = point.multipliers[np.imag(point.multipliers) > 0.0]
    if not len(upper):
        return Classified()
    multiplier = complex(upper[np.argmin(np.abs(np.abs(upper) - 1.0))])
    form = problem.normal_form("neimark-sacker", point.u, point.value, multiplier)
    resonance = strong_resonance(multiplier)
    remarks = (f"near the strong resonance {resonance}",) if resonance else ()
    if form is None:
        return Classified(None, None, remarks)
    return Classified("supercritical" if form[0] < 0.0 else "subcritical", form[0], remarks)
