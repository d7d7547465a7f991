"""Pages of the gallery, made when the site is built: each example with its picture, its command and its source."""

from __future__ import annotations

import ast
import re
import struct
from pathlib import Path
from typing import NamedTuple

DOCS = Path(__file__).resolve().parent
FOLDER = DOCS.parent / "examples"

GROUPS = {
    "Teaching": ("teaching", "Ten minutes each: one command, one question."),
    "Studies": ("", "What `contvines diagram` reads."),
    "Scripts": ("", "From Python."),
    "Machines": ("machines", "One file of Python each: equations of motion and contacts."),
    "Structures": ("structures", "Matrices of mass, damping and stiffness, with contacts."),
    "Design": ("design", "In kilograms and hertz."),
    "Compiled": ("compiled", "Right-hand sides in C."),
    "A paper's figures": (
        "gallery",
        "Figures of Youssef, Karoui and Leine (arXiv:2505.04420), redrawn and checked.",
    ),
}
"""Heading -> folder of examples, and a sentence."""

LANGUAGES = {".py": "python", ".toml": "toml"}
LONG = 66  # letters of a heading; a longer one ends at its first comma
NO_EXAMPLES = {"draw", "paper", "two_impacts"}  # what examples of a folder share


class Example(NamedTuple):
    """An example: its file, the name of its page, and headings."""

    path: Path
    name: str
    group: str
    title: str


def listed() -> list[Example]:
    """All examples, in the order of the gallery."""
    found = []
    for group, (folder, _) in GROUPS.items():
        for path in sorted((FOLDER / folder).glob("*")):
            wanted = {".toml"} if group == "Studies" else {".py"} if group == "Scripts" else {".py", ".toml"}
            other = ".py" if folder == "teaching" else ".toml"  # of a study and its file of Python
            twin = path.suffix == other and path.with_suffix({".py": ".toml", ".toml": ".py"}[other]).exists()
            if path.suffix in wanted and path.stem not in NO_EXAMPLES and not twin:
                found.append(Example(path, "-".join(filter(None, (folder, path.stem))), group, _title(path)))
    return found


def _title(path: Path) -> str:
    """The first sentence at the top of a file."""
    source = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        text = ast.get_docstring(ast.parse(source)) or path.stem
    else:
        lines = [line for line in source.split("\n\n")[0].splitlines() if re.match(r"#[^:]", line)]
        text = "\n".join(line.lstrip("# ") for line in lines) or path.stem
    first = " ".join(text.split("\n\n")[0].split())
    title = first.split(". ")[0].split(": ")[0].rstrip(".")
    return title if len(title) < LONG else re.split(r"[;,] (?![^(]*\))", title)[0]


def write(target: Path) -> None:
    """Write the gallery's first page and a page of every example into a folder."""
    target.mkdir(exist_ok=True)
    lines = ["# Gallery", "", "Every example of the repository; a picture leads to its page.", ""]
    names = []
    for group, (_, sentence) in GROUPS.items():
        members = [example for example in listed() if example.group == group]
        if not members:
            continue
        lines += [f"## {group}", "", sentence, "", '<div class="gallery">']
        for one in members:
            names.append(one.name)
            look = ' class="tall"' if _tall(one.name) else ""
            lines += [
                f'<a href="{one.name}.html"><img{look} src="../_static/gallery/{one.name}.png" alt="" loading="lazy"><span>{_safe(one.title)}</span></a>'
            ]
            _page(one, target)
        lines += ["</div>", ""]
    lines += ["```{toctree}", ":hidden:", "", *names, "```", ""]
    _keep(target / "index.md", "\n".join(lines))


def verb_of(study: Path) -> str:
    """The command that a study is an example of."""
    return "random" if "\n[random]" in study.read_text(encoding="utf-8") else "diagram"


def _page(one: Example, target: Path) -> None:
    path = one.path.relative_to(FOLDER.parent)
    run = (
        f"contvines {verb_of(one.path)} {path} --plot picture.png"
        if path.suffix == ".toml"
        else f"python examples/machines/draw.py pictures {path.stem}"
        if path.parent.name == "machines"
        else f"python {path}"
    )
    picture = f"![{one.title}]({one.name}.png)"
    if _tall(one.name):
        picture = f'<img src="{one.name}.png" width="520" alt="{one.title.replace(chr(34), "")}">'
    text = f"""# {one.title}

{picture}

```sh
{run}
```

"""
    for suffix, language in ((path.suffix, None), (".py", "python"), (".toml", "toml"), (".c", "c")):
        file = path.with_suffix(suffix)
        if language is None or (suffix != path.suffix and (FOLDER.parent / file).exists()):
            text += f"""
`{file}`:

```{{literalinclude}} ../../{file}
:language: {language or LANGUAGES[suffix]}
```
"""
    _keep(target / f"{one.name}.md", text)


def _tall(name: str) -> bool:
    """Whether the picture of an example is higher than wide: panels one above another."""
    with (DOCS / "gallery" / f"{name}.png").open("rb") as file:
        width, height = struct.unpack(">II", file.read(24)[16:])
    return height > width


def _keep(path: Path, text: str) -> None:
    """Write what has changed only, so that a second build reads the others from its memory."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def _safe(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")
