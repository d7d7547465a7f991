"""Invariant circles near Neimark-Sacker points (modulated motions): from the normal form to their breakdown."""
