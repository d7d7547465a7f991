"""What equilibria and cycles of a flow say of its attractors: by simulation, and of a solution that is known to be stable."""

from __future__ import annotations

from typing import Any

import numpy as np


class Witnessed:
    """`witness` and `attractor` of equilibria and cycles, as their flow tells."""

    flow: Any

    def witness(self, p: float, starts: int = 16) -> list[dict[str, Any]]:
        """See :meth:`FlowProblem.witness`."""
        return self.flow.witness(self, p, starts)

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """See :meth:`FlowProblem.known`."""
        return self.flow.known(self, u, p)
