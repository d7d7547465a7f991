"""How functions are compiled, and compiled arithmetic that all kernels share."""
