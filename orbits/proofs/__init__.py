"""Proofs: orbits that certainly exist, in ball arithmetic (python-flint), and certificates that anybody can check.

`Orbit.prove` and `OrbitProblem.prove` end here. What is proved and what is assumed: `docs/proofs.md`.
"""

from orbits.proofs.obstacles import Obstacle, ProofError
from orbits.proofs.proof import Proof

__all__ = ["Obstacle", "Proof", "ProofError"]
