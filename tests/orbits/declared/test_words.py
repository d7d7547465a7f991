"""Words over any contacts."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orbits.words import Word
from tools.pages.pages import page


@pytest.mark.parametrize(
    "text", ["LR", "tt", "ss", "s-s+", "LsR", "LtsR", "LttR", "LtLR", "RLtL", "LsRs", "LtLRttLR"]
)
def test_one_friction_and_two_walls_read_as_the_built_in_words(text):
    """The declared alphabet of the absorber has the built-in letters, modes and text."""
    mine, theirs = page("absorber").word(text), Word.parse(text)
    assert mine.events == theirs.events
    assert tuple(mode[2] for mode in mine.modes) == theirs.modes
    assert page("absorber").word(mine.text) == mine
    assert (mine.impacts, mine.repetitions) == (theirs.impacts, theirs.repetitions)
    assert mine.mirror_symmetric_halves == theirs.mirror_symmetric_halves


def test_switches_alternate_and_may_be_long():
    word = page("elastic_stop").word("stop+stop-")
    assert word.events == ("stop+", "stop-") and word.modes == ((1,), (-1,))
    assert word.text == "stop+ stop-"
    with pytest.raises(ValueError, match="must alternate"):
        page("elastic_stop").word("stop+ stop+")


EVENTS = st.lists(st.sampled_from(["A", "B", "C", "D"]), min_size=1, max_size=9)


@settings(deadline=None)
@given(EVENTS, st.integers(0, 20))
def test_rotations_and_mirrors_are_one_cycle(events, places):
    machine = page("two_absorbers")
    word = machine.word("".join(events))
    assert word.rotate(places).canonical() == word.canonical() == word.mirror().canonical()
    assert word.mirror().mirror() == word
    assert word.repeat(3).repetitions % 3 == 0
    assert isinstance(word, Word) and machine.word(word.text) == word
