"""Lines that cannot be understood, refused in one sentence each: what is wrong, and a way out."""

import difflib
import re
from itertools import pairwise

from contvines.shared.near_names import did_you_mean


def refusal(error: Exception, words: list[str]) -> str:
    """A usage error of the command line as one sentence; empty for a bare `contvines`, which asks for help.

    Parameters
    ----------
    error : the exception of the parser; known by its name and attributes, whichever module it comes from.
    words : the line.
    """
    kind, option = type(error).__name__, getattr(error, "option_name", "")
    message = " ".join(str(getattr(error, "message", "")).split())
    place = _command(error, words)
    if kind == "NoArgsIsHelpError":
        return ""
    if kind == "MissingParameter":
        return _missing(error, place)
    if kind == "NoSuchOption":
        near = list(getattr(error, "possibilities", None) or ())
        hint = f"did you mean {' or '.join(near)}?" if near else f"`{place} --help` lists those there are."
        return f"{option}: there is no such option; {hint}"
    if "requires an argument" in message:
        return f"{option}: its value is missing; `{place} --help` says what it takes."
    if "does not take a value" in message:
        return f"{option}: this option takes no value; write {option} alone."
    if message.startswith("No such command"):
        return _no_command(error, message)
    extra = re.search(r"unexpected extra arguments?(?:\(s\))? \((.*)\)", message)
    if extra:
        context = getattr(error, "ctx", None)
        options = {parameter.name for parameter in context.command.params} if context else set()
        file = " a file to write is given by --output FILE," if "output" in options else ""
        return f"{extra[1]}: this is too much for `{place}`;{file} `{place} --help` says what it takes."
    return _bad_value(error, message, words) or (
        f"{message.rstrip('.')}; see `{place} --help`." if message else ""
    )


def _command(error: Exception, words: list[str]) -> str:
    """The command that was called, as far as the line tells."""
    known = getattr(getattr(error, "ctx", None), "command_path", None)
    if known and known != "contvines":
        return str(known)
    named = [word for word in words[:1] if not word.startswith("-") and not _is_unknown(error, word)]
    return " ".join(["contvines", *named])


def _is_unknown(error: Exception, word: str) -> bool:
    commands = getattr(getattr(getattr(error, "ctx", None), "command", None), "commands", None)
    return commands is not None and word not in commands


def _missing(error: Exception, place: str) -> str:
    param = getattr(error, "param", None)
    options = sorted(getattr(param, "opts", ()), key=len)
    if not options or not options[-1].startswith("-"):
        name = getattr(param, "metavar", None) or (options[-1].upper() if options else "something")
        return f"{name} is missing; `{place} --help` says what it is."
    choices = re.findall(r"[\w-]+", _shown(error).partition("Choose from:")[2])
    what = f"choose one of {', '.join(choices)}" if choices else f"`{place} --help` says what it is"
    return f"{options[-1]} is missing; {what}."


def _shown(error: Exception) -> str:
    """The parser's own words."""
    shown = getattr(error, "format_message", None)
    return str(shown()) if callable(shown) else ""


def _no_command(error: Exception, message: str) -> str:
    name = message.split("'")[1] if "'" in message else message
    commands = list(getattr(getattr(getattr(error, "ctx", None), "command", None), "commands", ()))
    near = difflib.get_close_matches(name, commands, n=1)
    hint = f"did you mean {near[0]}?" if near else f"choose one of {', '.join(commands)}."
    return f"{name}: there is no such command; {hint}"


def _no_choice(place: str, given: str, quoted: str) -> str:
    """A value that is none of the choices, which typer quotes."""
    choices = re.findall(r"'([^']*)'", quoted)
    return (
        f"{place}: there is no such choice{did_you_mean(given, choices)}; choose one of {', '.join(choices)}."
    )


def _bad_value(error: Exception, message: str, words: list[str]) -> str:
    """An option's value that cannot be."""
    names = sorted(getattr(getattr(error, "param", None), "opts", ()), key=len)
    if not names or not names[-1].startswith("-"):
        value, found, choices = message.rpartition(" is not one of ")
        given = re.search(r"'([^']*)'$", value)
        return _no_choice(given[1], given[1], choices) if found and given else ""
    typed = next((n for n in names if any(w == n or w.startswith(f"{n}=") for w in words)), names[-1])
    typed = typed if typed.startswith("--") else names[-1]
    given = [w.split("=", 1)[1] for w in words if w.startswith(f"{typed}=")]
    given += [value for name, value in pairwise(words) if name in names]
    place = " ".join([typed, *given[:1]])
    if " is not one of " in message:
        return _no_choice(place, given[0] if given else "", message.rsplit(" is not one of ", 1)[1])
    if "valid number" in message or "valid integer" in message or "valid float" in message:
        return f"{place}: this is not a number; give one such as {'3' if 'integer' in message else '0.02'}."
    end = re.search(r"(greater|less) than (or equal to )?(\S+?)\.?$", message) or re.search(
        r"not in the range x?([<>])(=?)(\S+?)\.?$", message
    )
    if end:
        side = "above" if end[1] in ("greater", ">") else "below"
        return f"{place}: give a number {f'{end[3]} or {side}' if end[2] else f'{side} {end[3]}'}."
    return ""
