"""The sub-commands: where each lives, and what the list of them says. A sub-command is imported when it is called."""

from importlib import import_module
from typing import Any

import typer
from typer.core import TyperCommand, TyperOption
from typer.main import get_command

COMMANDS = {
    "diagram": ("run", "Automatic bifurcation diagram of a study; an interrupted run goes on."),
    "trace": ("run", "Follow the study's one branch, without switching."),
    "switch": ("run", "Follow the branch that leaves a special point, and add it to the file."),
    "atlas": (
        "run",
        "All coexisting motions: many starts are simulated, and all that they reach is continued.",
    ),
    "basins": (
        "basins",
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
        "circle",
        "Follow the invariant circles (modulated motions) of a Neimark-Sacker point until they break up.",
    ),
    "show": ("show", "List branches, special points and switches."),
    "orbit": ("orbit", "One orbit: its events, multipliers and margins."),
    "prove": ("prove", "Prove that orbits exist, are real or virtual, stable or unstable."),
    "plot": ("plot", "Draw a result: the diagram, the multipliers of a branch, or the network of branches."),
    "rerun": ("rerun", "Compute a result again from the study that its file keeps, and list what differs."),
    "export": ("export", "Write a result for other programs: csv, json, graphml, mat, latex, auto or xpp."),
    "report": ("report", "Write a result as one HTML page, which needs no network."),
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
    "help": ("help", "List the commands by task, or explain one command or topic."),
    "new": ("new", "Write a commented study to begin with: every field with its meaning."),
    "doctor": (
        "doctor",
        "Print versions, the core that computes, the extras that are installed, and the result of a self-test.",
    ),
    "schema": (
        "editor_schema",
        "Print the JSON Schema of studies, for editors that complete and check TOML.",
    ),
}
"""Name of the sub-command, and of its function: the file of this folder, and the first sentence of what it says of itself."""


class Command(TyperCommand):
    """A command that takes no option's name for the value of the option before it."""

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
    """The sub-command of a name, with all its options."""
    own = typer.Typer(add_completion=False, rich_markup_mode=None)
    own.command(name, cls=Command)(getattr(import_module(f"contvines.command.{COMMANDS[name][0]}"), name))
    found = get_command(own)
    assert isinstance(found, TyperCommand)
    return found


class Listed(TyperCommand):
    """A sub-command of which nothing is known but its name and its sentence until it is called."""

    def get_short_help_str(self, limit: int = 0) -> str:
        """The whole sentence, which goes on in further lines of the list."""
        return str(self.help)

    def make_context(self, info_name: str | None, args: list[str], parent: Any = None, **extra: Any) -> Any:
        return command(str(self.name)).make_context(info_name, args, parent=parent, **extra)


def register(app: typer.Typer) -> None:
    """Add all sub-commands to the app, in the order in which they are listed."""
    for name, (_, sentence) in COMMANDS.items():
        app.command(name, cls=Listed, help=sentence)(_unknown)


def _unknown() -> None:
    """What stands for a function that has not been imported."""
