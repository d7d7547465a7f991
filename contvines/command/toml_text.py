"""TOML text to nested dicts; what is no TOML is refused in a sentence that says the way out."""

import re
import tomllib
from typing import Any

LARGEST = 1_000_000  # bytes of a study; those of people have a few hundred
DEEPEST = 8  # sections in sections; a study has one level of them, and lists of lists
_LINE = re.compile(r"^\s*(?P<key>[\w.\-\"']+)\s*=\s*(?P<value>[^#]*?)\s*(#.*)?$")
_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")
_WORD = re.compile(r"[^\W\d][\w.+ -]*")
_YES_NO = {
    "yes": "true",
    "on": "true",
    "no": "false",
    "off": "false",
    **{word: word.lower() for word in ("True", "TRUE", "False", "FALSE")},
}


class TomlError(ValueError):
    """Text that is no TOML, or none that a study could be; the message says why and a way out."""


def toml_data(text: str) -> dict[str, Any]:
    """The nested dicts of a TOML text.

    Raises
    ------
    TomlError
        If it is not TOML, too large, or nested too deeply.
    """
    if len(text) > LARGEST:
        raise TomlError(f"this is too long for a study ({len(text)} characters; at most {LARGEST})")
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise TomlError(f"this is not valid TOML: {_hint(text) or error}") from None
    except ValueError:  # of Python, which reads no numbers so long
        raise TomlError("this is not valid TOML: a number has thousands of digits") from None
    except RecursionError:
        raise TomlError(
            "its values are nested too deeply; a study has sections of keys, one level deep"
        ) from None
    if _deeper_than(data, DEEPEST):
        raise TomlError("its sections are nested too deeply; a study has sections of keys, one level deep")
    return data


def _deeper_than(value: object, levels: int) -> bool:
    """Whether there are more levels than that; without recursion, which they may exhaust."""
    level = [value]
    for _ in range(levels + 1):
        nested = [v for v in level if isinstance(v, dict | list)]
        if not nested:
            return False
        level = [part for v in nested for part in (v.values() if isinstance(v, dict) else v)]
    return True


def _hint(text: str) -> str:
    """What is wrong with the first line that is no TOML, and a way out; empty where it is not one of people's habits."""
    lines = text.splitlines()
    for number, line in enumerate(lines, start=1):
        found = _LINE.match(line[:1000])
        what = _habit(found["value"]) if found else ""
        if found and what:
            what = f"{found['key'][:60]} = {found['value'][:60]} (line {number}): {what}"
            return what if _is_toml("\n".join(lines[: number - 1])) else ""
    return ""


def _habit(value: str) -> str:
    if _COMMA.fullmatch(value):
        return f"decimals are written with a point: write {value.replace(',', '.')}"
    if value in _YES_NO:
        return f"write {_YES_NO[value]}"
    if _WORD.fullmatch(value) and value not in ("true", "false", "inf", "nan"):
        return f'text stands in quotes: write "{value[:60]}"'
    return "" if value else "the value is missing"


def _is_toml(text: str) -> bool:
    try:
        tomllib.loads(text)
    except (ValueError, RecursionError):
        return False
    return True
