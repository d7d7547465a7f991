"""Words: parsing, transformations, refusals."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from orbits.words import Word, WordError

SAMPLES = ["LR", "RL", "RLtL", "tt", "ss", "LRts", "LRtt", "LsRs", "Lt", "s+s-", "RtRL", "sttstt"]
words = st.sampled_from(SAMPLES).map(Word.parse)


@pytest.mark.parametrize(
    ("text", "events", "modes"),
    [
        ("LR", "LR", (-1, 1)),
        ("RL LR RR", "RLRt", (1, -1, 1, -1)),  # the impact maps G_RL, G_LR, G_RR
        ("LR RL", "LR", (-1, 1)),
        ("RLtL", "RLtL", (1, -1, 1, -1)),
        ("LRs", "LRsu", (-1, 1, 0, 1)),
        ("ss", "susu", (0, 1, 0, -1)),
        ("s-s+", "susu", (0, -1, 0, 1)),
        ("tt", "tt", (1, -1)),
    ],
)
def test_events_and_maps_are_read(text, events, modes):
    word = Word.parse(text)
    assert "".join(word.events) == events
    assert word.modes == modes


def test_without_friction_flights_reverse_freely():
    assert Word.parse("LL", frictionless=True).events == ("L", "L")
    assert Word.parse("LL LR RL", frictionless=True).events == ("L", "L", "R")
    with pytest.raises(WordError, match="no events without friction"):
        Word.parse("RLtL", frictionless=True)


@given(words)
def test_text_is_read_back(word):
    assert Word.parse(word.text) == word


@given(words, st.integers(-7, 7))
def test_canonical_form_is_one_for_rotations_and_mirror_images(word, places):
    assert word.rotate(places).canonical() == word.canonical()
    assert word.mirror().canonical() == word.canonical()
    assert word.mirror().mirror() == word
    assert word.rotate(places).rotate(-places) == word


@given(words, st.integers(1, 5))
def test_root_undoes_repetition(word, times):
    repeated = word.repeat(times)
    assert repeated.primitive_root() == word.primitive_root()
    assert repeated.repetitions == times * word.repetitions
    assert repeated.impacts == times * word.impacts


def test_symmetric_halves():
    assert Word.parse("LR").mirror_symmetric_halves
    assert Word.parse("tt").mirror_symmetric_halves
    assert Word.parse("LsRs").mirror_symmetric_halves
    assert not Word.parse("LRtt").mirror_symmetric_halves
    assert not Word.parse("LRLR").mirror_symmetric_halves


def test_long_words_are_shortened_in_messages():
    with pytest.raises(WordError) as caught:
        Word.parse("LR" * 200 + "L")
    assert f"word '{'LR' * 20}...' cannot be" in str(caught.value)


def test_one_motion_has_one_spelling_and_all_are_read():
    """Rotations and mirror images, signs and written slips: the same name, from which the same motion is read."""
    families = [
        ("LRLt", "LtLR", "RLtL", "LRtR", "RtRL", "tRLR"),
        ("ss", "s+s-", "s-s+", "s u s u", "usus"),
        ("LRs", "RsL", "LsR", "LsuR", "sRL", "RLs-"),
        ("LR", "RL", "LR RL"),
    ]
    for family in families:
        assert {Word.parse(text).spelled() for text in family} == {family[0]}
        assert Word.parse(family[0]).canonical() == Word.parse(family[-1]).canonical()
    # without a mirror image they are two motions
    assert Word.parse("LRLt").spelled(mirror=False) != Word.parse("LRtR").spelled(mirror=False)


@pytest.mark.parametrize("text", ["s+s+s-", "s+s-", "s+s+s-s-s+", "ts+ts-s-"])
def test_words_of_sticks_alone_and_their_mirror_images_have_one_canonical_form(text):
    word = Word.parse(text)
    for other in (word.mirror(), *(word.rotate(k) for k in range(len(word)))):
        assert other.canonical() == word.canonical()
    assert (word.canonical(mirror=False) == word.mirror().canonical(mirror=False)) == any(
        word.rotate(k) == word.mirror() for k in range(len(word))
    )
