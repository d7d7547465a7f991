"""What the help adds for the file that stands on the line: the measure that is drawn when none is named."""

from pathlib import Path

ENDINGS = (".toml", ".vines")
WITH_Y = ("diagram", "atlas", "trace", "plot")


def help_note(words: list[str]) -> str:
    """A line on the default of -y for the study or graph among the words, or nothing."""
    command = next((word for word in words if not word.startswith("-")), "")
    files = [Path(word) for word in words if word.endswith(ENDINGS) and Path(word).is_file()]
    if command not in WITH_Y or not files:
        return ""
    try:
        name = _of_study(files[0]) if files[0].suffix == ".toml" else _of_graph(files[0])
    except (ValueError, OSError):
        return ""  # the command itself says what is wrong with the file
    return f"For {files[0]} the default of -y is {name}.\n" if name else ""


def _of_study(path: Path) -> str:
    from contvines.command.study import read_study
    from orbits.machines.catalogue import NAMES, model_class

    study = read_study(path)
    if study.flow is not None:
        return "max x0"
    if study.name in NAMES:
        return model_class(study.name).default_measure
    from orbits.flows.page.measures import shown_first

    return shown_first(study.machine)


def _of_graph(path: Path) -> str:
    from contvines.graph.graph import Graph
    from contvines.graph.measures import default_measure
    from contvines.store import load

    graph = load(path)
    return default_measure(graph) if isinstance(graph, Graph) else ""
