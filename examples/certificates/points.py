"""Proves every special point of the example studies and of the gallery's diagrams, verifies the certificates, writes `points.md`.

python examples/certificates/points.py            # all; some minutes
python examples/certificates/points.py friction   # one of them
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from unittest import mock

import contvines as cv
from orbits.proofs.checker import Refused, check

HERE = Path(__file__).parent
EXAMPLES = HERE.parent
STUDIES = ("friction", "friction_low", "frequency")
SCRIPTS = ("charts", "inclined_cavity")  # of the gallery, those that make diagrams
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
    """The graphs that a script of the gallery makes."""
    found = []
    original = cv.diagram

    def remembered(*given, **options):
        found.append(original(*given, **options))
        return found[-1]

    sys.path.insert(0, str(EXAMPLES / "gallery"))
    with mock.patch.object(cv, "diagram", remembered):
        __import__(name).main()
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
        word = "".join(proof.motif.events) + (" + mirror image" if proof.motif.half else "")
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


def main(names=()):
    """Prove all; returns the number of points that are not proved within the goal, real or virtual, and verified."""
    head = ["point", "kind", "word", "parameter", "value", "radius", "the orbit is", "verified", "seconds"]
    lines, open_, count = [], 0, 0
    for name, graph in graphs(names):
        lines += ["", f"## {name}", "", "| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
        for row in prove(graph):
            lines.append("| " + " | ".join(row) + " |")
            print(name, *row, flush=True)
            count += 1
            open_ += not (row[5] and float(row[5]) <= GOAL and row[6] != "open" and row[7] == "yes")
    head = f"# Special points, proved\n\n{count} points; {count - open_} of them with a radius of at most {GOAL:g}, decided to be real or virtual, and verified."
    print(head)
    if not names:
        (HERE / "points.md").write_text(head + "\n" + "\n".join(lines) + "\n", encoding="utf-8")
    return open_


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]) > 0)
