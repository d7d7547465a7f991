"""Kill and interrupt commands at random times, and run two of them at once, to check that their files stay right.

Usage: python -m tools.stopping KILLS INTERRUPTS PAIRS [SALT] [VERB ...]

KILLS and INTERRUPTS are numbers over all verbs, PAIRS is a number for each verb. After each kill or interrupt the same command runs again; its
result must equal that of an undisturbed run, and no other file may remain. Two commands on one file, the second one started at a random
time, must both succeed. Each printed line, except the last one of a verb, is a finding.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from contvines.graph import Graph
from contvines.graph.persistence import same_graph
from contvines.store import load
from tests.children import adopt

STUDY = """
[model]
name = "absorber"
restitution = 0.76
friction = 0.5
gravity = 0.211
mass_ratio = 0.006
[start]
word = "LR"
amplitude = 0.55
[continue]
parameter = "amplitude"
within = [0.5, 0.62]
depth = 1
[atlas]
values = 2
starts = 8
scan = 2
[sweep]
count = 12
transient = 60
[survey]
vary = { friction = { values = [0.48, 0.5, 0.52, 0.54] } }
gaps = 0
"""
WIDE = STUDY.replace("within = [0.5, 0.62]", "within = [0.2, 1.2]")
HOUSE = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1]), "MPLBACKEND": "Agg"}
SWITCHED = ("SB1", "WG1")

Word = str | Path


def line(*words: Word) -> list[str]:
    """Return the command line of a separate process."""
    return [sys.executable, "-m", "contvines.command", *map(str, words)]


def vines(folder: Path) -> Any:
    """Read the graph or chart that a verb has written."""
    return load(folder / "x.vines", problems=False)


def text(folder: Path) -> Any:
    """Read the table that a verb has written."""
    return (folder / "x.csv").read_bytes()


def survey(folder: Path) -> Any:
    """Read the survey and its table."""
    from contvines.survey import load_survey

    found = load_survey(folder / "x.nc")
    columns = {name: column.tobytes() for name, column in found.columns.items()}
    return columns, [str(note) for note in found.notes.ravel()], (folder / "x.csv").read_bytes()


def same(one: Any, other: Any) -> bool:
    """Whether two results are equal bit for bit; charts to rounding, because a resumed locus has new bordering vectors."""
    if isinstance(one, Graph):
        return same_graph(one, other)
    if hasattr(one, "loci"):
        return _alike(json.loads(json.dumps(one.to_dict())), json.loads(json.dumps(other.to_dict())))
    return one == other


def _alike(one: Any, other: Any) -> bool:
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(_alike(one[k], other[k]) for k in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(_alike, one, other))
    if isinstance(one, float) and isinstance(other, float):
        return one == other or one != one or abs(one - other) <= 1e-12 * (1.0 + abs(one))
    return one == other


class Verb:
    """A verb on a small study.

    Parameters
    ----------
    words : list
        Arguments of the command.
    read : callable
        Reads the result that is compared from a folder.
    second : list, optional
        Arguments of the second command of a pair; default: the same.
    beside : str
        Name of a prepared file that is copied to x.vines before the command runs.
    """

    def __init__(
        self,
        words: list[Word],
        read: Callable[[Path], Any],
        second: list[Word] | None = None,
        beside: str = "",
    ) -> None:
        self.words, self.second, self.read, self.beside = words, second or words, read, beside

    def folder(self, prepared: Path, place: Path) -> Path:
        """Make an empty folder with the files that the verb needs."""
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        for name in ("s.toml", "d.vines"):
            shutil.copy(prepared / name, place)
        if self.beside:
            shutil.copy(prepared / self.beside, place / "x.vines")
        return place


VERBS = {
    "diagram": Verb(["diagram", "s.toml", "-o", "x.vines"], vines),
    "trace": Verb(["trace", "s.toml", "-o", "x.vines"], vines),
    "atlas": Verb(["atlas", "s.toml", "-o", "x.vines"], vines),
    "chart": Verb(["chart", "d.vines", "--over", "friction", "--within", "0.48", "0.52", "-o", "x.vines"], vines),
    "locus": Verb(["locus", "d.vines", "LP1", "--over", "friction", "--within", "0.48", "0.52", "-o", "x.vines"], vines),
    "switch": Verb(["switch", "x.vines", SWITCHED[0]], vines, ["switch", "x.vines", SWITCHED[1]], "wide.vines"),
    "prove": Verb(["prove", "x.vines", "B1:2", "B1:5"], vines, ["prove", "x.vines", "B1:3"], "d.vines"),
    "sweep": Verb(["sweep", "s.toml", "-o", "x.csv"], text),
    "survey": Verb(["survey", "s.toml", "--workers", "2", "-o", "x.nc"], survey),
}  # fmt: skip


def prepare(folder: Path) -> None:
    """Write the study, and the diagrams with which some verbs begin."""
    (folder / "s.toml").write_text(STUDY)
    (folder / "w.toml").write_text(WIDE)
    small = STUDY.replace('word = "LR"', 'word = "LRLRLR"\nperiods = 3').replace("0.55", "0.58")
    (folder / "d.toml").write_text(small)
    for words in (["diagram", "d.toml", "--no-look"], ["trace", "w.toml", "-o", "wide.vines"]):
        subprocess.run([*line(*words), "-q"], cwd=folder, check=True, env=HOUSE)


def run(words: list[Word], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(line(*words), cwd=folder, capture_output=True, text=True, timeout=600, env=HOUSE)


def names(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


def struck(name: str, prepared: Path, whole: Path, seconds: float, blow: int, chance: random.Random) -> str:
    """Send the signal `blow` at a random time and run the same command again; return a sentence if the result is wrong."""
    verb = VERBS[name]
    folder = verb.folder(prepared, prepared / "struck")
    after = chance.uniform(0.0, 1.1 * seconds)
    process = subprocess.Popen(
        line(*verb.words), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=HOUSE
    )
    time.sleep(after)
    process.send_signal(blow)
    _, said = process.communicate(timeout=600)
    ours = "contvines" in said  # False if Python was interrupted before it ran the package
    if blow == signal.SIGINT and process.returncode not in (0, 130, -signal.SIGINT) and ours:
        return f"after {after:.3f} s of {seconds:.3f} it ended with {process.returncode}: {said[-500:]}"
    again = run(verb.words, folder)
    what = compared(verb, folder, whole, [again])
    return f"stopped after {after:.3f} s of {seconds:.3f}: {what}" if what else ""


def paired(name: str, prepared: Path, wholes: list[Path], seconds: float, chance: random.Random) -> str:
    """Run two commands at once; return a sentence if the result is wrong."""
    verb = VERBS[name]
    folder = verb.folder(prepared, prepared / "paired")
    after = chance.uniform(0.0, seconds)
    ended = []
    processes = []
    for words in (verb.words, verb.second):
        processes.append(
            subprocess.Popen(
                line(*words), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=HOUSE
            )
        )
        if len(processes) == 1:
            time.sleep(after)
    for process in processes:
        out, err = process.communicate(timeout=600)
        ended.append(subprocess.CompletedProcess(process.args, process.returncode, out, err))
    found = [compared(verb, folder, whole, ended) for whole in wholes]
    return "" if "" in found else f"{after:.3f} s apart: {found[0]}"


def compared(verb: Verb, folder: Path, whole: Path, ended: list[subprocess.CompletedProcess[str]]) -> str:
    """Compare with the undisturbed folder; return a sentence if exit status, files or result differ, else an empty text."""
    for done in ended:
        if done.returncode != 0:
            return f"exit status {done.returncode}: {done.stderr[-500:]}"
    if names(folder) != names(whole):
        return f"there are {names(folder)}"
    try:
        return "" if same(verb.read(folder), verb.read(whole)) else "another result"
    except ValueError as error:
        return str(error)


def main(kills: int, interrupts: int, pairs: int, salt: str, verbs: list[str]) -> int:
    """Run all checks; return the number of findings."""
    chance, findings = random.Random(salt), 0
    with tempfile.TemporaryDirectory() as place:
        prepared = Path(place)
        prepare(prepared)
        blows = [*[signal.SIGKILL] * kills, *[signal.SIGINT] * interrupts]
        for k, name in enumerate(verbs):
            verb, wholes, seconds = VERBS[name], [], 0.0
            orders = [[verb.words, verb.second], [verb.second, verb.words]]
            single = verb.folder(prepared, prepared / f"{name}-alone")
            run(verb.words, single)  # first run, which compiles
            single = verb.folder(prepared, prepared / f"{name}-alone")
            begun = time.monotonic()
            assert run(verb.words, single).returncode == 0
            seconds = time.monotonic() - begun
            for i, order in enumerate(orders if verb.second is not verb.words else [orders[0]]):
                wholes.append(verb.folder(prepared, prepared / f"{name}-{i}"))
                for words in order:
                    assert run(words, wholes[-1]).returncode == 0
            found = [struck(name, prepared, single, seconds, blow, chance) for blow in blows[k :: len(verbs)]]
            found += [paired(name, prepared, wholes, seconds, chance) for _ in range(pairs)]
            wrong = [sentence for sentence in found if sentence]
            for sentence in wrong:
                print(f"{name}: {sentence}", flush=True)
            findings += len(wrong)
            print(f"{name}: {len(found) - pairs} blows and {pairs} pairs, {len(wrong)} findings", flush=True)
    return findings


if __name__ == "__main__":
    adopt()
    counts = [int(word) for word in sys.argv[1:4]]
    salt, *chosen = sys.argv[4:] or ["0"]
    sys.exit(1 if main(counts[0], counts[1], counts[2], salt, chosen or list(VERBS)) else 0)
