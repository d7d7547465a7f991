"""Words over any contacts: parsing, transformations, refusals."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orbits.contacts.switch import Switch
from orbits.contacts.wall import WallLaw
from orbits.words import Word, WordError
from orbits.words.alphabet import Alphabet
from tools.pages.pages import page

SAMPLES = ["LR", "RL", "RLtL", "tt", "ss", "LRts", "LRtt", "LsRs", "Lt", "s+s-", "RtRL", "sttstt"]
STICKS = ["s+s+s-", "s+s-", "s+s+s-s-s+", "ts+ts-s-"]
EVENTS = st.lists(st.sampled_from("ABCD"), min_size=1, max_size=9)
words = st.one_of(
    st.sampled_from([*SAMPLES, *STICKS]).map(Word.parse),
    EVENTS.map(lambda events: page("two_absorbers").word("".join(events))),
)


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
    assert ("".join(word.events), word.modes) == (events, modes)


@pytest.mark.parametrize("text", [*SAMPLES, "LtsR", "LttR", "LtLR", "LtLRttLR"])
def test_one_friction_and_two_walls_read_as_the_built_in_words(text):
    """The declared alphabet of the absorber has the built-in letters, modes and text."""
    mine, theirs = page("absorber").word(text), Word.parse(text)
    assert mine.events == theirs.events
    assert tuple(mode[2] for mode in mine.modes) == theirs.modes
    assert page("absorber").word(mine.text) == mine and Word.parse(theirs.text) == theirs
    assert (mine.impacts, mine.repetitions) == (theirs.impacts, theirs.repetitions)
    assert mine.mirror_symmetric_halves == theirs.mirror_symmetric_halves


def test_without_friction_flights_reverse_freely():
    assert Word.parse("LL", frictionless=True).events == ("L", "L")
    assert Word.parse("LL LR RL", frictionless=True).events == ("L", "L", "R")
    with pytest.raises(WordError, match="no events without friction"):
        Word.parse("RLtL", frictionless=True)


@settings(deadline=None)
@given(words, st.integers(-7, 20), st.integers(1, 5))
def test_rotations_mirror_images_and_repetitions_are_one_cycle(word, places, times):
    assert word.rotate(places).canonical() == word.canonical() == word.mirror().canonical()
    assert word.mirror().mirror() == word == word.rotate(places).rotate(-places)
    turned = any(word.rotate(k) == word.mirror() for k in range(len(word)))
    assert (word.canonical(mirror=False) == word.mirror().canonical(mirror=False)) == turned
    repeated = word.repeat(times)
    assert repeated.primitive_root() == word.primitive_root()
    assert repeated.repetitions == times * word.repetitions
    assert repeated.impacts == times * word.impacts


def test_symmetric_halves():
    halves = {text for text in (*SAMPLES, "LRLR") if Word.parse(text).mirror_symmetric_halves}
    assert halves == {"LR", "RL", "tt", "ss", "s+s-", "LsRs", "sttstt"}


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


def test_switches_alternate_and_may_be_long():
    word = page("elastic_stop").word("stop+stop-")
    assert word.events == ("stop+", "stop-") and word.modes == ((1,), (-1,))
    assert word.text == "stop+ stop-"
    with pytest.raises(ValueError, match="must alternate"):
        page("elastic_stop").word("stop+ stop+")


def test_a_switch_whose_surface_changes_its_sign_in_the_mirror_is_crossed_the_other_way():
    """x > 0 becomes x < 0 where all states change sign; a surface such as x^2 > 1 stays what it is."""
    contacts = (WallLaw("L"), WallLaw("R"), Switch("K", abs), Switch("E", abs))
    alphabet = Alphabet(contacts=contacts, mirror={0: 1, 1: 0, 2: 2, 3: 3}, turned=frozenset({2}))
    assert alphabet.images == {"L": "R", "R": "L", "K+": "K-", "K-": "K+", "E+": "E+", "E-": "E-"}
    mode = alphabet.with_entry(alphabet.with_entry((0, 0, 0, 0), 2, 1), 3, 1)
    assert alphabet.mirrored_mode(mode) == (0, 0, -1, 1)
    assert alphabet.mirrored_mode(alphabet.mirrored_mode(mode)) == mode
