"""Make the pictures of the gallery: `python -m tools.gallery [NAME ...]` runs the examples and writes a small picture of each to docs/gallery.

When the site is built, `docs/gallery_pages.py` makes a page for every example with its picture.
"""

from __future__ import annotations

import runpy
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

TOP = Path(__file__).parents[1]
EXAMPLES, PICTURES = TOP / "examples", TOP / "docs" / "gallery"
sys.path.insert(0, str(TOP / "docs"))  # gallery_pages
WIDTH = 760  # width of a picture in pixels
COLUMN = 3.4  # width in inches of the paper's figures, whose panels are placed one above another
SIZE = (5.2, 3.4)  # size in inches of pictures without a size of their own

PLAIN = {
    "henon": lambda module: module["main"]().plot(y="x0", ylim=(-2.0, 4.0), figsize=SIZE),
    "pitchfork": lambda module: module["perturbed"]().plot(y="u0", figsize=SIZE),
    "neutral_saddle": lambda module: module["main"]().plot(y="u1", figsize=SIZE),
    "absorber": lambda module: module["main"]().plot(y="B", figsize=SIZE),
}
"""Scripts that draw no picture: name -> function that draws one from the script's global names."""


def _script(path: Path, *words: str) -> None:
    """Run a script with these arguments."""
    subprocess.run([sys.executable, str(path), *words], check=True)


def _study(path: Path) -> None:
    """Run a study with its command and draw the result."""
    from gallery_pages import verb_of

    contvines = [sys.executable, "-m", "contvines.command"]
    size = ["--size", *map(str, SIZE), *(["-y", "phase"] if path.stem == "bouncing_ball" else [])]
    if verb_of(path) != "diagram":
        subprocess.run([*contvines, verb_of(path), str(path), "--plot", "a.png"], check=True)
        return
    subprocess.run([*contvines, "diagram", str(path), "--quiet"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([*contvines, "plot", f"{path.stem}.vines", *size, "--trust", "-o", "a.png"], check=True)


def draw(path: Path) -> None:
    """Draw one example; its picture becomes the only .png in the working folder."""
    if path.suffix == ".toml":
        _study(path)
    elif path.parent.name == "machines":
        _script(path.with_name("draw.py"), ".", path.stem)
    elif path.parent.name == "gallery":
        _script(path, ".", "--width", str(COLUMN))
    elif path.stem in PLAIN and path.parent == EXAMPLES:
        PLAIN[path.stem](runpy.run_path(str(path))).savefig("a.png")
    else:
        _script(path)


def keep(path: Path, name: str) -> None:
    """Write a picture in reduced size to docs/gallery; colours change by a few parts of 255."""
    from PIL import Image

    with Image.open(path) as image:
        height = round(image.height * WIDTH / image.width)
        small = image.convert("RGB").resize((WIDTH, height), Image.Resampling.LANCZOS)
    small.quantize(256, kmeans=3, dither=Image.Dither.NONE).save(PICTURES / f"{name}.png", optimize=True)


def main(names: list[str]) -> None:
    """Draw the examples with these names, or all of them."""
    import contextlib
    import os
    import time

    from gallery_pages import listed

    PICTURES.mkdir(exist_ok=True)
    os.environ["PYTHONPATH"] = str(TOP)
    for example in listed():
        if names and example.name not in names:
            continue
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            begun = time.perf_counter()
            draw(example.path)
            keep(next(Path(folder).rglob("*.png")), example.name)
        print(f"{example.name}: {time.perf_counter() - begun:.0f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
