"""Words: the events of a periodic motion, and the modes between them."""

from orbits.words.word import Word, WordError

__all__ = ["Word", "WordError"]
