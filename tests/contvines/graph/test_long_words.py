"""Long words in tables: what is left out is counted."""

import pytest

from contvines.graph.table import short_word, told_apart

SHORT = {
    "LtRLttR" * 8: "(LtRLttR)^8",
    "deep+ holds- deep- holds+": "deep+ holds-... 4 events",
    "holds-[--] deep+[+-] holds+[++] deep-[-+]": "holds-[--]... 4 events",
    "hit stick_1 slip_1 hit stick_1 slip_1 hit stick_1 slip_1": "(hit stick_1 slip_1)^3",
    "s+LtRLttRLtRLttRLLtRtttLsLR": "s+LtRLttRLtRLttR... 26 events",
    "holds-[--] holds+": "holds-[--] holds+",
}


@pytest.mark.parametrize("word", SHORT)
def test_what_a_long_word_becomes(word):
    assert short_word(word) == SHORT[word]


def test_different_words_have_different_short_forms():
    words = ["L1 t2 t2 R1 R2 L2", "L1 t2 L2 R2 R1 L2", "LR", "LR"]
    short = told_apart(words, 14)
    assert list(short) == words[:3] and len(set(short.values())) == 3
    assert short["LR"] == "LR"
