"""What many starts of a machine settle on."""

from orbits.population.population import Population

__all__ = ["Population"]
