"""The command `contvines`: its sub-commands, and how errors reach a user (as sentences).

Each sub-command lives in a file of this folder and has a line in `commands.py`. Importing this module must stay cheap:
numpy, matplotlib, rich and pydantic are imported by the commands that need them.
"""

import atexit
import gc
import re
import sys
from pathlib import Path
from typing import Annotated

import typer

from contvines.command.commands import register
from contvines.command.options import option

LONGEST = 200  # letters of a word in a sentence (paths aside)
QUOTES = "'\""

app = typer.Typer(
    name="contvines",
    help="Continuation and bifurcation analysis of motions with impacts and friction, of maps and of flows.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # help texts are printed as they are written: in markup what stands in brackets is lost
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        from contvines import __version__

        typer.echo(f"contvines {__version__}")
        raise typer.Exit


@app.callback(
    epilog="A first study: contvines new absorber, then contvines diagram absorber.toml --plot absorber.png. "
    "By task: contvines help.",
)
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    debug: Annotated[
        bool, option("--debug", "Show the traceback of an error (anywhere on the line).")
    ] = False,
) -> None:
    pass


register(app)


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; every error ends as a sentence on stderr and a non-zero exit status."""
    gc.set_threshold(300_000, 20, 100)  # imports and compiled code make many objects that stay
    atexit.register(gc.freeze)  # else Python looks through them all before it ends: a fifth of a short run
    words = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in words
    words = [w for w in words if w != "--debug"]
    try:
        status = app(words, prog_name="contvines", standalone_mode=False)
    except Exception as error:
        if debug:
            raise
        explain = getattr(error, "show", None)
        if callable(explain):  # the line itself cannot be understood
            from contvines.command.refusals import refusal

            about = refusal(error, words)
            if about:
                print(f"contvines: {about}", file=sys.stderr)
            else:
                explain()
            sys.exit(getattr(error, "exit_code", 2))
        if type(error).__name__ in ("Interrupted", "Abort"):
            stopped(str(error))
        print(f"contvines: {sentence(error)}", file=sys.stderr)
        sys.exit(1)
    if {"-h", "--help"} & set(words) and any(Path(word).suffix in (".toml", ".vines") for word in words):
        from contvines.command.asked_measures import help_note

        print(end=help_note(words))
    if status == 130:  # Ctrl-C outside the computation
        stopped()
    sys.exit(status if isinstance(status, int) else 0)


def stopped(note: str = "") -> None:
    """End after Ctrl-C: say what is kept and how to go on, exit status 130."""
    print(
        f"\ncontvines: stopped; {note or 'nothing new is kept; run the same command again'}.", file=sys.stderr
    )
    sys.exit(130)


def sentence(error: Exception) -> str:
    """An error for people: our own errors are sentences already, others are named."""
    if isinstance(error, KeyError) and error.args and " " in str(error.args[0]):
        text = str(error.args[0])
    elif isinstance(error, ValueError) and str(error):
        text = str(error)
    elif isinstance(error, OSError) and error.strerror:
        text = f"{error.filename or 'a file'}: {error.strerror}"
    else:
        text = (
            f"something went wrong that should not ({type(error).__name__}: {error}); "
            "the same command with --debug shows where"
        )
    text = re.sub(
        rf"[^\s/]{{{LONGEST},}}", lambda m: f"{m[0][:60]}... ({len(m[0].strip(QUOTES))} letters)", text
    )
    return text if text.endswith((".", "?")) or "\n" in text else text + "."
