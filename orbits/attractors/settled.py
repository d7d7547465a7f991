"""What can be asked of any attractor."""

from __future__ import annotations

from typing import Any

import numpy as np


class Settled:
    """An attractor; beside what is here it has `model`, `params`, `kind`, `state` (from which a simulation goes on), `periods`, `word`, `text`,
    `impacts`, `symmetric`, `recurrent`, `guess` (nodes as a study takes them, None where no word describes the motion), `dots` (what a picture of a
    sweep shows of it) and `distance` to another one.
    """

    kind: str

    @property
    def found(self) -> Any:
        """The orbit; `ValueError` if it is none that can be continued."""
        raise TypeError(f"{type(self).__name__} does not say which orbit it is")

    def problem(self, parameter: str | None = None, symmetric: bool | None = None) -> Any:
        """The attractor as a continuation problem, so that it can be handed to `contvines.diagram`.

        Raises
        ------
        ValueError
            If it is no orbit that can be continued.
        """
        return self.found.problem(parameter, symmetric)

    def seed(self, problem: Any) -> tuple[np.ndarray, float]:
        """Unknowns and parameter value in `problem`."""
        return self.found.seed(problem)
