"""From a word to a first orbit."""
