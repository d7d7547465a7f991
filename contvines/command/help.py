"""`contvines help`: the commands by task, one command's help, or a topic."""

from __future__ import annotations

import difflib
import textwrap
from typing import Annotated

import typer

from contvines.command.commands import COMMANDS, command
from contvines.command.options import argument

TASKS = {
    "Begin": ("help", "new", "doctor", "schema"),
    "Compute a diagram": ("diagram", "trace", "switch", "atlas", "sweep"),
    "Look at a result": ("show", "plot", "orbit", "report", "export", "rerun"),
    "Two parameters": ("locus", "chart", "circle"),
    "How safe is a motion": ("basins", "robustness", "prove"),
    "Design a device": ("design", "recommend", "survey", "transient", "random", "calibrate"),
}
"""Task -> commands, in the order in which they are wanted."""

TOPICS = ("labels", "words", "cite")

WORDS = """An orbit's word lists its events over one period, in order:

  L R   impact on the left wall (w = +1), on the right wall (w = -1)
  t     turn: the sliding velocity passes zero and the mass slides back
  s     stick, with the slip that ends it
  ""    no event: the mass sticks all the time

LR repeats after one impact on each wall; LRLt after two impacts on the left,
one on the right and a turn. A study begins with `word` and `periods`, the
number of forcing periods after which the orbit repeats. `contvines orbit
FILE.vines LABEL` lists the events of an orbit with their times."""


def help(
    name: Annotated[
        str | None,
        argument("COMMAND|TOPIC", f"A command, or a topic: {', '.join(TOPICS)}. Without: all commands."),
    ] = None,
) -> None:
    """List the commands by task, or explain one command or topic.

    contvines help diagram says the same as contvines diagram --help.
    """
    if name in COMMANDS:
        own = command(str(name))
        with own.make_context(f"contvines {name}", [], resilient_parsing=True) as context:
            typer.echo(own.get_help(context))
    elif name == "words":
        typer.echo(WORDS)
    elif name == "cite":
        typer.echo(_cite())
    elif name == "labels":
        typer.echo(_labels())
    elif name is None:
        typer.echo(_by_task())
    else:
        near = difflib.get_close_matches(name, [*COMMANDS, *TOPICS], n=1)
        hint = f"did you mean {near[0]}?" if near else "`contvines help` lists the commands"
        raise ValueError(f"{name}: there is no such command or topic; {hint}")


def _by_task() -> str:
    listed = {name for names in TASKS.values() for name in names}
    tasks = {**TASKS, "Further commands": tuple(name for name in COMMANDS if name not in listed)}
    blocks = []
    for task, names in tasks.items():
        if names:
            lines = (
                textwrap.fill(
                    COMMANDS[name][1], 80, initial_indent=f"  {name:12}", subsequent_indent=" " * 14
                )
                for name in names
            )
            blocks.append("\n".join([task, *lines]))
    blocks.append(
        "Topics\n  labels      What LP, SB, PD, VG and the other labels mean.\n"
        "  words       How a motion is written: LR, LRtt.\n"
        "  cite        BibTeX of this version."
    )
    blocks.append(
        "A first study: contvines new absorber,\n"
        "then contvines diagram absorber.toml --plot absorber.png\n"
        "`contvines help COMMAND` explains one of them."
    )
    return "\n\n".join(blocks)


def _cite() -> str:
    from importlib.metadata import metadata

    about = metadata("contvines")
    author = about["Author"] or about["Author-email"] or "The contvines developers"
    return f"""@software{{contvines,
  title = {{contvines: continuation and bifurcation analysis of motions with impacts and friction}},
  author = {{{{{author}}}}}, year = {{2026}}, version = {{{about["Version"]}}}
}}
The model of the absorbers: Youssef, Karoui, Leine, doi:10.48550/arXiv.2505.04420."""


def _labels() -> str:
    from contvines.bifurcation.kinds import KINDS

    rows = [f"  {kind.label}  {kind.text or kind.name}{' (border)' if kind.border else ''}" for kind in KINDS]
    return "\n".join(
        [
            "A label is the kind and a number: SB1 is the first symmetry breaking. B1 is a branch.",
            "",
            *rows,
            "",
            "At a border an event appears or vanishes: a margin of the orbit is zero there.",
            "`contvines show FILE.vines` lists the special points of a result.",
        ]
    )
