"""Long words for tables and captions; files keep them whole."""

from __future__ import annotations

import re
import textwrap
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from ..shared.motions import MODULATIONS


def short_word(word: str, limit: int = 24) -> str:
    """A word of events in at most about `limit` characters.

    A word that repeats a shorter one is written with its power, ``(LtRLttR)^8``; what is still too long is cut, with the
    number of its events (between blanks where their names are long; else letters, as signs such as those of ``s+`` belong to the event before them). Names of modulations stay as they are.
    """
    if len(word) <= limit or word in MODULATIONS:
        return word
    joint = " " if " " in word else ""  # names of several letters stand apart
    length = (word + joint + word).find(word, 1)  # of the shortest root, with its joint
    power = f"^{(len(word) + len(joint)) // length}" if length < len(word) else ""
    root = word[:length].rstrip()
    if len(root) > limit:
        shown = re.sub(r"\[[^\]]*\]", "", root)  # without modes, which are no events
        events = len(shown.split()) if joint else sum(letter.isalpha() for letter in shown)
        cut = root[: limit - 8]
        root = f"{cut[: cut.rfind(joint)] if joint else cut}... {events} events"
    return f"({root}){power}" if power else root


def told_apart(words: Iterable[str], limit: int = 24) -> dict[str, str]:
    """Short forms of words by word: those of different words differ, and are longer where they have to be."""
    limits = dict.fromkeys(words, limit)
    while True:
        short = {word: short_word(word, most) for word, most in limits.items()}
        times = Counter(short.values())
        alike = [word for word, most in limits.items() if times[short[word]] > 1 and most < len(word)]
        if not alike:
            return short
        limits.update((word, 2 * limits[word]) for word in alike)


def short_text(text: str) -> str:
    """A text on one line of at most 100 characters, cut between words."""
    return textwrap.shorten(text, 100, placeholder=" ...", break_on_hyphens=False)


def motion_name(description: Mapping[str, Any]) -> str:
    """How tables and pictures call a motion: its word, or, where nothing happens on it, what its problem calls that ("stuck", "no events")."""
    return short_word(str(description.get("word") or description.get("name", "")))


def short_words(text: str) -> str:
    """A sentence with its long words shortened."""
    return " ".join(short_word(part) for part in text.split(" "))
