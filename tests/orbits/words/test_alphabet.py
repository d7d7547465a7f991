"""Mirror images of letters and modes."""

from orbits.contacts.switch import Switch
from orbits.contacts.wall import WallLaw
from orbits.words.alphabet import Alphabet


def test_a_switch_whose_surface_changes_its_sign_in_the_mirror_is_crossed_the_other_way():
    """x > 0 becomes x < 0 where all states change sign; a surface such as x^2 > 1 stays what it is."""
    contacts = (WallLaw("L"), WallLaw("R"), Switch("K", abs), Switch("E", abs))
    alphabet = Alphabet(contacts=contacts, mirror={0: 1, 1: 0, 2: 2, 3: 3}, turned=frozenset({2}))
    assert alphabet.images == {"L": "R", "R": "L", "K+": "K-", "K-": "K+", "E+": "E+", "E-": "E-"}
    mode = alphabet.with_entry(alphabet.with_entry((0, 0, 0, 0), 2, 1), 3, 1)
    assert alphabet.mirrored_mode(mode) == (0, 0, -1, 1)
    assert alphabet.mirrored_mode(alphabet.mirrored_mode(mode)) == mode
