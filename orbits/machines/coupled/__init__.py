"""The absorber on its oscillator, without approximation."""
