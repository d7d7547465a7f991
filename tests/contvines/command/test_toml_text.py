"""Text of a study: how deep it may be nested, and what is said of people's habits."""

import pytest

from contvines.command.toml_text import DEEPEST, TomlError, toml_data


def nested(levels):
    return f"[{'.'.join('a' * levels)}]\nb = 1\n"


def test_sections_may_be_nested_so_deep_and_no_deeper():
    assert toml_data("[model]\nfriction = 0.5\n") == {"model": {"friction": 0.5}}
    deepest = next(n for n in range(1, 60) if _refused(nested(n))) - 1
    assert deepest == DEEPEST - 1  # the text itself is a level
    with pytest.raises(TomlError, match="nested too deeply"):
        toml_data("a = " + "[" * (DEEPEST + 1) + "]" * (DEEPEST + 1))


def _refused(text):
    try:
        toml_data(text)
    except TomlError:
        return True
    return False


def test_numbers_of_thousands_of_digits_are_refused():
    with pytest.raises(TomlError, match="thousands of digits"):
        toml_data("[model]\nfriction = " + "1" * 5001)
