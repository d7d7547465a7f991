"""Usage errors of the command line as one sentence each: the error and a remedy."""

from __future__ import annotations

import difflib
import re
from itertools import pairwise
from typing import Any

from ..shared.near_names import did_you_mean


def refusal(error: Any, words: list[str]) -> str:
    """Describe a usage error of the command line in one sentence; empty for `contvines` without a command, which prints help.

    Parameters
    ----------
    error : exception
        Of the parser; recognised by its name and attributes, as its module may differ.
    words : list of str
        The command line.
    """
    kind, message, context = type(error).__name__, " ".join(str(error.message).split()), error.ctx
    commands: Any = getattr(context.command, "commands", None) if context else None
    place = context.command_path if context else "contvines"
    if place == "contvines":  # the command called, as far as the line shows it
        called = [word for word in words[:1] if not word.startswith("-")]
        place = " ".join([place, *(word for word in called if commands is None or word in commands)])
    option = getattr(error, "option_name", "")
    if kind == "NoArgsIsHelpError":
        return ""
    if kind == "MissingParameter":
        name = max(error.param.opts, key=len)
        name = name if name.startswith("-") else error.param.metavar or name.upper()
        return f"{name} is missing; `{place} --help` says what it is."
    if kind == "NoSuchOption":
        near = error.possibilities or ()
        hint = f"did you mean {' or '.join(near)}?" if near else f"`{place} --help` lists those there are."
        return f"{option}: there is no such option; {hint}"
    if "requires an argument" in message:
        return f"{option}: its value is missing; `{place} --help` says what it takes."
    if "does not take a value" in message:
        return f"{option}: this option takes no value; write {option} alone."
    if message.startswith("No such command"):
        name = message.split("'")[1]
        names = list(commands or ())
        near = difflib.get_close_matches(name, names, n=1)
        hint = f"did you mean {near[0]}?" if near else f"choose one of {', '.join(names)}."
        return f"{name}: there is no such command; {hint}"
    if extra := re.search(r"unexpected extra arguments?(?:\(s\))? \((.*)\)", message):
        writes = context and any(parameter.name == "output" for parameter in context.command.params)
        file = " a file to write is given by --output FILE," if writes else ""
        return f"{extra[1]}: this is too much for `{place}`;{file} `{place} --help` says what it takes."
    return _bad_value(error, message, words) or (
        f"{message.rstrip('.')}; see `{place} --help`." if message else ""
    )


def _bad_value(error: Any, message: str, words: list[str]) -> str:
    """Describe an invalid value of an option or argument."""
    names = sorted(getattr(getattr(error, "param", None), "opts", ()), key=len)
    sentence, no_choice, quoted = message.rpartition(" is not one of ")
    if names and names[-1].startswith("-"):
        typed = next((n for n in names if any(w == n or w.startswith(f"{n}=") for w in words)), names[-1])
        typed = typed if typed.startswith("--") else names[-1]
        given = [w.split("=", 1)[1] for w in words if w.startswith(f"{typed}=")]
        given += [value for name, value in pairwise(words) if name in names]
        place = " ".join([typed, *given[:1]])
    else:
        given = re.findall(r"'([^']*)'$", sentence)
        place = "".join(given)
    if no_choice and place:
        choices = re.findall(r"'([^']*)'", quoted)
        return f"{place}: there is no such choice{did_you_mean(''.join(given[:1]), choices)}; choose one of {', '.join(choices)}."
    if re.search("valid (number|integer|float)", message) and place:
        return f"{place}: this is not a number; give one such as {'3' if 'integer' in message else '0.02'}."
    end = re.search(r"(greater|less) than (or equal to )?(\S+?)\.?$", message) or re.search(
        r"not in the range x?([<>])(=?)(\S+?)\.?$", message
    )
    if end and place:
        side = "above" if end[1] in ("greater", ">") else "below"
        return f"{place}: give a number {f'{end[3]} or {side}' if end[2] else f'{side} {end[3]}'}."
    return ""
