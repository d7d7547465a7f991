"""Measure the size of the code: ``python -m tools.figures``.

Tokens of Python are those of its own tokenizer without comments, docstrings and line ends; tokens of the native core are words and signs
without comments.
"""

from __future__ import annotations

import argparse
import ast
import io
import json
import re
import subprocess
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
SOURCE = ("orbits", "contvines", "native")
SILENT = (
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
)
CPP_TOKEN = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\])*\"|[\w.]+|[^\s\w]", re.S)
SMALL_FLOAT = re.compile(r"^\d+(\.\d*)?[eE][-+]?\d+$")


def files(*folders: str) -> Iterator[Path]:
    """Yield the source files in some folders of the repository."""
    for folder in folders:
        for path in sorted((TOP / folder).rglob("*")):
            if path.suffix in (".py", ".hpp", ".cpp", ".h") and "__pycache__" not in path.parts:
                yield path


def docstring_lines(text: str) -> set[int]:
    """Return the lines on which docstrings begin."""
    found = set()
    for node in ast.walk(ast.parse(text)):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and isinstance(body[0], ast.Expr):
            value = body[0].value
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                found.add(value.lineno)
    return found


def python_tokens(text: str) -> Iterator[tokenize.TokenInfo]:
    """Yield the tokens of a Python file without comments, docstrings and line ends."""
    skipped = docstring_lines(text)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type in SILENT or (token.type == tokenize.STRING and token.start[0] in skipped):
            continue
        yield token


def count_tokens(path: Path) -> int:
    """Number of tokens of one file."""
    text = path.read_text()
    if path.suffix == ".py":
        return sum(1 for _ in python_tokens(text))
    return sum(1 for token in CPP_TOKEN.findall(text) if not token.startswith(("//", "/*")))


def small_floats(path: Path) -> int:
    """Number of constants in scientific notation in a Python file."""
    if path.suffix != ".py":
        return 0
    tokens = python_tokens(path.read_text())
    return sum(1 for token in tokens if token.type == tokenize.NUMBER and SMALL_FLOAT.match(token.string))


def any_types(path: Path) -> int:
    """Number of annotations that consist of `Any` alone."""
    return len(re.findall(r"(?::|->) Any\b", path.read_text())) if path.suffix == ".py" else 0


def executed_files() -> int:
    """Number of files of the two packages whose code runs during one diagram, from TOML to picture."""
    script = """
import os, sys, tempfile, shutil, pathlib
seen = set()
def note(frame, event, argument):
    seen.add(frame.f_code.co_filename)
top = sys.argv[1]
folder = pathlib.Path(tempfile.mkdtemp())
shutil.copy(pathlib.Path(top) / "examples" / "friction.toml", folder / "study.toml")
os.chdir(folder)  # where nothing is finished yet
sys.setprofile(note)
from contvines.command.entry import main
sys.argv = ["contvines", "diagram", str(folder / "study.toml"), "--plot", str(folder / "study.png")]
try:
    main()
except SystemExit:
    pass
sys.setprofile(None)
own = [name for name in seen if name.startswith((top + "/contvines", top + "/orbits"))]
print(len(own), file=sys.stderr)
"""
    done = subprocess.run(
        [sys.executable, "-c", script, str(TOP)], cwd=TOP, capture_output=True, text=True, timeout=600
    )
    return int(done.stderr.strip().splitlines()[-1])


def figures(run: bool = True) -> dict[str, int]:
    """Return all figures by name; `run` includes those for which a diagram is computed."""
    source, tests, tools = list(files(*SOURCE)), list(files("tests")), list(files("tools"))
    found = {
        "tokens of the source": sum(map(count_tokens, source)),
        "tokens of the tests": sum(map(count_tokens, tests)),
        "tokens of the tools": sum(map(count_tokens, tools)),
        "lines of native/": sum(len(path.read_text().splitlines()) for path in files("native")),
        "files of the source": len(source),
        "Any alone as a type": sum(map(any_types, source)),
        "floats in scientific notation outside settings.py": sum(
            small_floats(path) for path in source if path.name != "settings.py"
        ),
    }
    if run:
        found["own files executed in a diagram"] = executed_files()
    return found


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="as JSON")
    parser.add_argument("--no-run", action="store_true", help="count only, run no diagram")
    options = parser.parse_args()
    found = figures(not options.no_run)
    if options.json:
        print(json.dumps(found, indent=1))
        return
    for name, value in found.items():
        print(f"{value:>9,}  {name}")


if __name__ == "__main__":
    main()
