"""Proves every special point of the examples' and the gallery's diagrams, verifies the certificates, writes `points.md`.

python examples/certificates/points.py            # all; some minutes
python examples/certificates/points.py friction   # one of them; the others' tables stay as they are
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from unittest import mock

import contvines as cv
from orbits.proofs.checker import Refused, check
from orbits.proofs.wording import spelling

HERE = Path(__file__).resolve().parent
EXAMPLES = HERE.parent
FILE = HERE / "points.md"
STUDIES = ("friction", "friction_low", "frequency", "bouncing_ball")
SCRIPTS = {
    "absorber": EXAMPLES,
    "inclined_cavity": EXAMPLES / "gallery",
}  # the gallery's charts begin at absorber's diagram
HEAD = ["point", "kind", "word", "parameter", "value", "radius", "the orbit is", "verified", "seconds"]
GOAL = 1e-10


def of_study(name):
    """The graph of a study."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.vines"
        command = [
            sys.executable,
            "-m",
            "contvines.command",
            "diagram",
            str(EXAMPLES / f"{name}.toml"),
            "-o",
            str(path),
        ]
        subprocess.run(command, check=True, capture_output=True)
        return [cv.load(path)]


def of_script(name):
    """The graphs that a script makes."""
    found = []
    original = cv.diagram

    def remembered(*given, **options):
        found.append(original(*given, **options))
        return found[-1]

    sys.path.insert(0, str(SCRIPTS[name]))
    with tempfile.TemporaryDirectory() as folder, mock.patch.object(cv, "diagram", remembered):
        os.chdir(folder)  # where the script leaves its pictures
        __import__(name).main()
        os.chdir(HERE)
    return found


def graphs(names=()):
    """Name and graph of every diagram."""
    for name in names or (*STUDIES, *SCRIPTS):
        made = of_study(name) if name in STUDIES else of_script(name)
        for i, graph in enumerate(made, 1):
            yield (name if len(made) == 1 else f"{name} ({i})"), graph


def prove(graph):
    """A row per special point: label, kind, word, parameter, value, radius, real, verified, seconds."""
    rows = []
    for label, point in graph.special.items():
        started = time.process_time()
        try:
            proof = point.prove()
        except ValueError as refusal:
            rows.append(
                [label, point.kind, "", point.parameter, f"{point.value:.12g}", "", "", str(refusal), ""]
            )
            continue
        seconds = f"{time.process_time() - started:.2f}"
        word = spelling(proof)
        value = proof.value[0][:22] if proof.value else f"{point.value:.12g}"
        verified = "nothing proved"
        if proof.existence:
            try:
                check(json.loads(json.dumps(proof.certificate())))
                verified = "yes"
            except Refused as refusal:
                verified = f"no: {refusal}"
        else:
            verified = "; ".join(map(str, proof.obstacles))
        real = {True: "real", False: "virtual", None: "open"}[proof.real]
        radius = "" if proof.radius is None else f"{proof.radius:.1e}"
        rows.append(
            [label, proof.kind, word or "stuck", point.parameter, value, radius, real, verified, seconds]
        )
    return rows


def good(row):
    """Whether a point is proved within the goal, decided to be real or virtual, and verified."""
    return bool(row[5]) and float(row[5]) <= GOAL and row[6] != "open" and row[7] == "yes"


def kept():
    """The tables that `points.md` holds, by name: rows of cells."""
    found, rows = {}, []
    for line in FILE.read_text(encoding="utf-8").splitlines() if FILE.exists() else []:
        if line.startswith("## "):
            rows = found[line[3:]] = []
        elif line.startswith("| ") and not line.startswith("| point |"):
            rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return found


def write(tables):
    """All tables, and how many of their points are proved."""
    rows = [row for table in tables.values() for row in table]
    done = sum(map(good, rows))
    lines = [
        "# Special points, proved",
        "",
        f"{len(rows)} points; {done} of them with a radius of at most {GOAL:g}, decided to be real or virtual, and verified.",
    ]
    for name, table in tables.items():
        lines += ["", f"## {name}", "", "| " + " | ".join(HEAD) + " |", "|" + "---|" * len(HEAD)]
        lines += ["| " + " | ".join(row) + " |" for row in table]
    FILE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(lines[2])
    return len(rows) - done


def main(names=()):
    """Prove all; returns the number of points that are not proved within the goal, decided, and verified."""
    tables, open_ = kept() if names else {}, 0
    for name, graph in graphs(names):
        tables[name] = prove(graph)
        for row in tables[name]:
            print(name, *row, flush=True)
        open_ = write(tables)
    return open_


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]) > 0)
