"""Studies: what is read, and the sentence for every value that cannot be used."""

import copy
import tomllib
from pathlib import Path

import pytest

from contvines.command.cli import sentence
from contvines.command.study import StudyError, check_study, read_study
from orbits.words import Word
from tests.contvines.studies import PAPER_MACHINE

GOOD = (
    PAPER_MACHINE
    + """[start]
word = "LR"
periods = 1
amplitude = 0.55
[continue]
parameter = "amplitude"
within = [0.2, 1.3]
"""
)
EXAMPLES = Path(__file__).parents[3] / "examples"


def study(**changes):
    """GOOD with section__key = value changes; None takes a key away."""
    data = copy.deepcopy(tomllib.loads(GOOD))
    for place, value in changes.items():
        section, _, key = place.partition("__")
        section = section.rstrip("_")
        if not key:
            if value is None:
                del data[section]
            else:
                data[section] = value
        elif value is None:
            del data[section][key]
        else:
            data.setdefault(section, {})[key] = value
    return check_study(data)


def test_a_good_study_is_read_with_its_defaults():
    read = study()
    assert read.name == "absorber"
    assert read.parameters == {
        "amplitude": 0.55,
        "restitution": 0.76,
        "friction": 0.5,
        "gravity": 0.211,
        "mass_ratio": 0.006,
        "frequency": 1.0,
    }
    assert (read.word, read.periods, read.guess) == ("LR", 1, None)
    assert (read.parameter, read.within, read.depth, read.virtual) == ("amplitude", (0.2, 1.3), 3, False)
    assert read.settings == {}


@pytest.mark.parametrize("start", [None, {"periods": 1}])
def test_a_study_without_a_word_begins_in_the_middle_of_its_interval(start):
    read = study(start=start)
    assert read.word is None
    assert read.parameters["amplitude"] == pytest.approx(0.75)  # of 0.2 to 1.3


def test_start_overrides_the_model():
    assert study(start__friction=0.1).parameters["friction"] == 0.1


def test_whole_numbers_pass_as_numbers():
    assert study(model__restitution=1, continue__within=[0, 1]).parameters["restitution"] == 1.0


def test_coupled_studies_have_their_own_parameters():
    model = {"name": "coupled", "restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": 0.006}
    start = {"word": "LR", "periods": 1, "forcing": 3.3, "frequency": 0.98}
    read = study(model=model, start=start, continue__parameter="frequency", continue__within=[0.95, 1.05])
    assert read.parameters["damping"] == 0.9
    assert read.parameters["frequency"] == 0.98
    assert read.parameters["excitation"] == 1.0
    truncated = study(
        model={**model, "excitation": "truncated"},
        start=start,
        continue__parameter="frequency",
        continue__within=[0.95, 1.05],
    )
    assert truncated.parameters["excitation"] == 0.0
    with pytest.raises(
        StudyError, match=r"\[model\] excitation = 'half' is not a number; expected 'exact', 'truncated'"
    ):
        study(model={**model, "excitation": "half"}, start=start)
    with pytest.raises(StudyError, match=r"\[start\] amplitude = 0.55: there is no such field"):
        study(model=model, continue__parameter="forcing")


@pytest.mark.parametrize(
    ("changes", "parts"),
    [
        ({"model__restitution": 1.5}, ["[model] restitution = 1.5"]),
        ({"model__restitution": 0}, ["[model] restitution = 0"]),
        ({"model__friction": -0.5}, ["[model] friction = -0.5"]),
        ({"start__periods": 100_000}, ["[start] periods = 100000", "whole number from 1 to 4096"]),
        ({"start__word": "LL"}, ["[start]", "LL"]),
        ({"start__word": "LxR"}, ["[start]", "x"]),
        ({"continue__within": [float("nan"), 1.3]}, ["[continue] within[0] = nan", "not a finite number"]),
        ({"model__restitution": 0.0}, ["[model] restitution = 0.0", "from 1e-6 to 1", "0.76"]),
        ({"start__word": "LR" * 50_000}, ["[start] word has 100000 letters", "a word of events such as"]),
        ({"model__restitution": "high"}, ["[model] restitution = 'high'", "not a number"]),
        ({"model__gravity": "9.81 m/s^2"}, ["[model] gravity = '9.81 m/s^2'", 'units = "si"', "first line"]),
        ({"model__restitution": None}, ["[model] restitution is missing", "0.76"]),
        ({"model__friction": float("nan")}, ["[model] friction = nan", "not a finite number"]),
        ({"model__restituton": 0.7}, ["[model] restituton = 0.7", "did you mean 'restitution'"]),
        ({"model__amplitude": 0.7}, ["[model] amplitude = 0.7", "belongs to [start]"]),
        ({"model__name": "absorbr"}, ["[model] name = 'absorbr'", "did you mean 'absorber'", "'coupled'"]),
        ({"model__name": None}, ["[model] name is missing", "'absorber'"]),
        ({"model": None}, ["[model] is missing"]),
        (
            {"continue_": None, "contnue": {"depth": 2}},
            ["[contnue]: there is no such section", "did you mean 'continue'"],
        ),
        ({"atlas": {"starts": -1}}, ["[atlas] starts = -1", "from 1 to 10000000"]),
        ({"atlas": {"values": 0}}, ["[atlas] values = 0 is out of range", "or a list of values"]),
        (
            {"chart": {"parameter": "friction", "within": [0.1, 0.5], "depht": 2}},
            ["[chart] depht = 2", "known are parameter, within"],
        ),
        ({"start__periods": 0}, ["[start] periods = 0", "whole number from 1 to 4096"]),
        ({"start__word": 3}, ["[start] word = 3", "not text"]),
        ({"start__amplitude": None}, ["[start] amplitude is missing", "from 0.2 to 1.3"]),
        ({"start__amplitude": 1.4}, ["[start] amplitude = 1.4", "outside [continue] within = [0.2, 1.3]"]),
        (
            {"start__guess": [[1.0, 0.5], [2.0]]},
            ["[start] guess[1] = [2.0]", "has 1 numbers", "[phase, B or w]"],
        ),
        ({"start__guess": [[1.0, float("nan")]]}, ["[start] guess[0][1] = nan", "not a finite number"]),
        (
            {"continue__parameter": "amplitud"},
            ["parameter = 'amplitud'", "did you mean 'amplitude'", "restitution"],
        ),
        ({"continue__within": [0.5, 0.5]}, ["[continue] within = [0.5, 0.5] is empty"]),
        (
            {"continue__within": [1.3, 0.2]},
            ["[continue] within = [1.3, 0.2] is reversed", "give the lower end first"],
        ),
        ({"continue__within": [0.2]}, ["[continue] within = [0.2] has 1 entries", "[low, high]"]),
        (
            {"continue__parameter": "restitution", "continue__within": [0.5, 1.2]},
            ["leaves the range of restitution at 1.2", "from 1e-6 to 1"],
        ),
        ({"continue__depth": -1}, ["[continue] depth = -1", ">= 0"]),
        ({"continue__depth": 2.0}, ["[continue] depth = 2.0", "not a whole number"]),
        ({"continue__virtual": "yes"}, ["[continue] virtual = 'yes'", "true or false"]),
        ({"sweep__count": 1}, ["[sweep] count = 1", ">= 2"]),
    ],
)
def test_every_bad_value_is_refused_by_name_with_the_expected_value(changes, parts):
    with pytest.raises(StudyError) as caught:
        study(**changes)
    message = str(caught.value)
    for part in parts:
        assert part in message
    assert "things to mend" not in message, message


def test_all_bad_values_are_told_together():
    with pytest.raises(StudyError) as caught:
        study(model__restitution=2.0, model__friction=-1.0, start__periods=0)
    message = str(caught.value)
    assert message.startswith("3 things to mend")
    for name in ("restitution", "friction", "periods"):
        assert name in message


def test_files_that_are_no_studies(tmp_path):
    with pytest.raises(StudyError, match="there is no such file"):
        read_study(tmp_path / "none.toml")
    with pytest.raises(StudyError, match="this is a folder"):
        read_study(tmp_path)
    bad = tmp_path / "bad.toml"
    bad.write_text("[model\nname = ")
    with pytest.raises(StudyError, match=r"bad\.toml: this is not valid TOML: .*line 1"):
        read_study(bad)
    bad.write_bytes(b"SQLite format 3\x00" + bytes(range(256)))
    with pytest.raises(StudyError, match="database"):
        read_study(bad)


def test_fingerprint_depends_on_what_decides_the_result_and_on_nothing_else(tmp_path):
    one = tmp_path / "one.toml"
    one.write_text(GOOD)
    other = tmp_path / "other.toml"
    other.write_text("# a comment\n" + GOOD.replace("0.76", "0.760") + "[sweep]\ncount = 10\n")
    assert read_study(one).fingerprint() == read_study(other).fingerprint()
    assert read_study(one).fingerprint() != read_study(one).fingerprint("trace")
    other.write_text(GOOD.replace("0.76", "0.7600001"))
    assert read_study(one).fingerprint() != read_study(other).fingerprint()


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda p: p.name)
def test_examples_are_good_studies(path):
    assert read_study(path).parameters


MANGLED = {
    "friction = 0,5": "friction = 0,5 (line 2): decimals are written with a point: write 0.5",
    "virtual = no": "virtual = no (line 2): write false",
    "word = LR  # the first orbit": 'word = LR (line 2): text stands in quotes: write "LR"',
    "friction =": "friction =  (line 2): the value is missing",
    "x = " + "[" * 100_000: "nested too deeply",
    "[" + ".".join(["a"] * 5_000) + "]": "nested too deeply",
    "x = " + "{a = " * 5_000 + "1" + "}" * 5_000: "nested too deeply",
    "\n".join(f"[[a{'.b' * (i % 50)}]]" for i in range(200)): "",
    "x" * 3_000_000 + " = 1": "too long for a study",
    "z" * 900_000 + " = 1": "zzz...",
    "\n".join(f"k{i} = {i}" for i in range(20_000)): "and 19",
}


@pytest.mark.parametrize("lines", MANGLED, ids=[str(i) for i in range(len(MANGLED))])
def test_text_that_is_no_study_gets_a_short_sentence(tmp_path, lines):
    path = tmp_path / "x.toml"
    path.write_text("[continue]\n" + lines)
    with pytest.raises(StudyError) as caught:
        read_study(path)
    assert MANGLED[lines] in str(caught.value) and len(str(caught.value)) < 6_000


def test_words_of_many_thousand_events_are_read_in_linear_time():
    """32768 letters: a quadratic step anywhere would take minutes and gigabytes."""
    for text in ("LR", "stt"):
        word = Word.parse(text * (32_768 // len(text)))
        assert word.canonical() == word.rotate(len(text)).canonical()


def test_a_sentence_is_cut_where_a_word_in_it_is_huge():
    assert len(sentence(ValueError("no orbit " + "LR" * 20_000 + " here"))) < 300


def test_files_of_windows_editors_are_read(tmp_path):
    text = (Path(__file__).parents[3] / "examples" / "friction.toml").read_text(encoding="utf-8")
    plain, marked, wide = (tmp_path / name for name in ("plain.toml", "marked.toml", "wide.toml"))
    plain.write_bytes(text.encode())
    marked.write_bytes(text.replace("\n", "\r\n").encode("utf-8-sig"))
    wide.write_bytes(text.encode("utf-16"))
    assert read_study(marked).parameters == read_study(plain).parameters
    with pytest.raises(StudyError, match="Save it as UTF-8"):
        read_study(wide)
