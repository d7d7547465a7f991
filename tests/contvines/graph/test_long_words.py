"""Long words in tables: what is left out is counted."""

import pytest

from contvines.graph.shortening import short_word

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
