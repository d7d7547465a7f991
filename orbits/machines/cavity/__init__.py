"""A cavity with two unlike walls, a slope and two frictions, shaken harmonically; the absorber is its level, symmetric case."""
