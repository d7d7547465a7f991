"""Invariant circles beside Neimark-Sacker points: modulated motions, from the normal form on until they break."""
