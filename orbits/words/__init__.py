"""Words: the events of a periodic motion, and the modes between them."""

from orbits.words.reading import WordError
from orbits.words.word import Word

__all__ = ["Word", "WordError"]
