"""What equilibria and cycles of a flow say of its attractors: by simulation, and of a solution that is known to be stable."""

from __future__ import annotations

from typing import Any

import numpy as np


class FlowAttractors:
    """`simulated_attractors` and `attractor` of equilibria and cycles, as their flow tells."""

    flow: Any

    def simulated_attractors(self, p: float, starts: int = 16) -> list[dict[str, Any]]:
        """See :meth:`FlowProblem.simulated_attractors`."""
        return self.flow.simulated_attractors(self, p, starts)

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """See :meth:`FlowProblem.known`."""
        return self.flow.known(self, u, p)
