"""Proofs of orbits and special points in ball arithmetic (python-flint), and certificates that a second program checks.

`Orbit.prove` and `OrbitProblem.prove` use this sub-package. `docs/proofs.md` lists the statements that are proved and the assumptions.
"""

from orbits.proofs.obstacles import Obstacle, ProofError
from orbits.proofs.proof import Proof

__all__ = ["Obstacle", "Proof", "ProofError"]
