"""The command `contvines`: its sub-commands, and the conversion of errors to messages.

Each sub-command is a function in a file of this folder, which is imported when the sub-command is called, and has a line in `COMMANDS`.
The import of this module must stay fast: numpy, matplotlib, rich and pydantic are imported by the commands that need them.
"""

from __future__ import annotations

import atexit
import gc
import re
import sys
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperOption
from typer.main import get_command

from .options import option

LONGEST = 200  # largest number of letters of a word in an error message, paths excepted
QUOTES = "'\""

COMMANDS = {
    "diagram": ("run", "Automatic bifurcation diagram of a study; an interrupted run goes on."),
    "trace": ("run", "Follow the study's one branch, without switching."),
    "switch": ("run", "Follow the branch that leaves a special point, and add it to the file."),
    "atlas": (
        "run",
        "All coexisting motions: many starts are simulated, and all that they reach is continued.",
    ),
    "basins": (
        "robustness",
        "Basins of attraction in a plane of starts: shares, uncertainty exponent of the boundary.",
    ),
    "robustness": (
        "robustness",
        "Robustness of a stable motion: the smallest kick out of its basin, the share of its basin.",
    ),
    "locus": ("chart", "Follow one special point of a result in a second parameter."),
    "chart": (
        "chart",
        "Chart of two parameters: loci of special points, codimension-two points, regions; an interrupted run goes on.",
    ),
    "circle": (
        "chart",
        "Follow the invariant circles (modulated motions) of a Neimark-Sacker point until they break up.",
    ),
    "show": ("results", "List branches, special points and switches."),
    "orbit": ("orbit", "One orbit: its events, multipliers and margins."),
    "prove": ("orbit", "Prove that orbits exist, are real or virtual, stable or unstable."),
    "plot": ("plot", "Draw a result: the diagram, the multipliers of a branch, or the network of branches."),
    "rerun": ("results", "Compute a result again from the study that its file keeps, and list what differs."),
    "export": ("results", "Write a result for other programs: csv, json, graphml, mat, latex, auto or xpp."),
    "report": ("results", "Write a result as one HTML page, which needs no network."),
    "sweep": (
        "sweep",
        "Simulate over the parameter, each value from the last state; an interrupted run goes on.",
    ),
    "survey": (
        "survey",
        "Diagrams of many machines: grids, tolerances, samples; an interrupted run goes on.",
    ),
    "recommend": (
        "recommend",
        "Recommend a clearance: theory first, then diagrams of all samples; an interrupted run goes on.",
    ),
    "calibrate": (
        "calibrate",
        "Estimate restitution, friction and the like from a measurement, with confidence intervals.",
    ),
    "transient": (
        "transient",
        "A start-up, a shock, a recorded base motion or a free decay, compared with the bare oscillator.",
    ),
    "random": (
        "random_excitation",
        "Response to a random excitation of given spectral density: statistics with error bars.",
    ),
    "design": (
        "design",
        "Design figures in physical units: activation threshold, upper bound, operating ratio, sticking and sliding limits.",
    ),
    "help": ("begin", "List the commands by task, or explain one command or topic."),
    "new": ("begin", "Write a commented study to begin with: every field with its meaning."),
    "doctor": (
        "begin",
        "Print versions, the core that computes, the extras that are installed, and the result of a self-test.",
    ),
    "schema": (
        "begin",
        "Print the JSON Schema of studies, for editors that complete and check TOML.",
    ),
}
"""Sub-commands by name, which is also that of the function: file in this folder, and first sentence of the function's docstring."""


class Command(TyperCommand):
    """A command that does not accept an option's name as the value of the option before it."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        options = {
            name: param
            for param in self.get_params(ctx)
            for name in (*param.opts, *param.secondary_opts)
            if name.startswith("-")
        }
        for k, name in enumerate(args):
            if name == "--":
                break
            option = options.get(name)
            if not isinstance(option, TyperOption) or option.is_flag or option.count:
                continue
            follows = next((word for word in args[k + 1 : k + 1 + option.nargs] if word in options), None)
            if follows:
                raise typer.BadParameter(
                    f"{name}: its value is missing, {follows} comes at once", ctx=ctx, param=option
                )
        return super().parse_args(ctx, args)


def command(name: str) -> TyperCommand:
    """Import and return the sub-command with a name."""
    sub_app = typer.Typer(add_completion=False, rich_markup_mode=None)
    sub_app.command(name, cls=Command)(getattr(import_module(f"contvines.command.{COMMANDS[name][0]}"), name))
    found = get_command(sub_app)
    assert isinstance(found, TyperCommand)
    return found


class Listed(TyperCommand):
    """A sub-command that is imported when it is called; until then only its name and its first sentence are known."""

    def get_short_help_str(self, limit: int = 0) -> str:
        """Return the whole sentence, which the list wraps."""
        return str(self.help)

    def make_context(self, info_name: str | None, args: list[str], parent: Any = None, **extra: Any) -> Any:
        return command(str(self.name)).make_context(info_name, args, parent=parent, **extra)


app = typer.Typer(
    name="contvines",
    help="Continuation and bifurcation analysis of motions with impacts and friction, of maps and of flows.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # help texts are printed unchanged; markup would remove texts in brackets
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        from .. import __version__

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


for name, (_, its_sentence) in COMMANDS.items():
    app.command(name, cls=Listed, help=its_sentence)(lambda: None)  # imported when it is called


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; every error becomes a message on stderr and a non-zero exit status."""
    gc.set_threshold(300_000, 20, 100)  # fewer collections: imports make many permanent objects
    atexit.register(gc.freeze)  # otherwise a collection at exit takes a fifth of a short run
    words = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in words
    words = [w for w in words if w != "--debug"]
    try:
        status = app(words, prog_name="contvines", standalone_mode=False)
    except Exception as error:
        if debug:
            raise
        if explain := getattr(error, "show", None):  # the line itself cannot be understood
            from .refusals import refusal

            if message := refusal(error, words):
                print(f"contvines: {message}", file=sys.stderr)
            else:
                explain()
            sys.exit(getattr(error, "exit_code", 2))
        if type(error).__name__ in ("Interrupted", "Abort"):
            stopped(str(error))
        print(f"contvines: {sentence(error)}", file=sys.stderr)
        sys.exit(1)
    if {"-h", "--help"} & set(words) and any(Path(word).suffix in (".toml", ".vines") for word in words):
        from .compose import help_note

        print(end=help_note(words))
    if status == 130:  # Ctrl-C outside the computation
        stopped()
    sys.exit(status if isinstance(status, int) else 0)


def stopped(note: str = "") -> None:
    """End the program after Ctrl-C with exit status 130; `note` says what is stored and how to continue."""
    print(
        f"\ncontvines: stopped; {note or 'nothing new is kept; run the same command again'}.", file=sys.stderr
    )
    sys.exit(130)


def sentence(error: Exception) -> str:
    """Return an error's message for users; errors of unexpected types are named."""
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
