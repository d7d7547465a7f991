"""The native core's functions in Python and numpy: a reference for tests, and a replacement if the core cannot be loaded."""
