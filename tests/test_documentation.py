"""The documentation builds as a site, without a warning; every page is on the way of a reader."""

import importlib
import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

DOCS = Path(__file__).parents[1] / "docs"
TOP = DOCS.parent
PAGES = {path.stem: path.read_text(encoding="utf-8") for path in DOCS.glob("*.md")}
CELLS = re.compile(r"```\{code-cell\} ipython3\n(.*?)```", re.DOTALL)


@pytest.mark.long
def test_the_site_builds_without_a_warning(tmp_path):
    for package in ("sphinx", "myst_nb", "numpydoc"):
        pytest.importorskip(package)
    line = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", str(DOCS), str(tmp_path / "site")]
    done = subprocess.run(line, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    assert (tmp_path / "site/concepts.html").exists()
    assert (tmp_path / "site/_static/gallery/henon.png").exists()


def test_every_page_is_in_the_contents():
    listed = "\n".join(re.findall(r"```\{toctree\}(.*?)```", PAGES["index"], re.DOTALL))
    assert PAGES.keys() - {"index"} == set(re.findall(r"^(\w+)$", listed, re.MULTILINE))


def test_every_link_of_a_page_leads_somewhere_on_the_site():
    # a page of the site, or a file that the site copies; a folder, or a page of Markdown elsewhere, would be a dead link
    links = [
        (name, target)
        for name, text in PAGES.items()
        for target in re.findall(r"\]\((?!\w+:|#|gallery/index)([^)#]+)", text)
    ]
    assert len(links) > 30
    for name, target in links:
        path = (DOCS / target).resolve()
        assert path.is_file() and (path.suffix != ".md" or path.parent == DOCS), f"{name}: {target}"


def test_the_labels_in_the_first_study_are_those_of_its_graph():
    text = PAGES["first_study"]
    cells = CELLS.findall(text)
    names: dict = {}
    for cell in cells[: 1 + next(i for i, cell in enumerate(cells) if "cv.diagram(" in cell)]:
        if ".plot(" not in cell:
            exec(cell, names)
    labels = set(re.findall(r"`([A-Z]{2}\d+)`", text)) | set(re.findall(r'graph\["(\w+)"\]', text))
    assert len(labels) >= 5
    assert not [label for label in labels if label not in names["graph"]]


ROOMS = {"attractors", "design", "machines", "multiple_scales", "simulation", "symbols", "theory", "words"}


@pytest.mark.parametrize(
    ("package", "pages"), [("contvines", ("python", "python_problems")), ("orbits", ("python_machines",))]
)
def test_every_public_name_is_in_the_reference(package, pages):
    text = "".join(PAGES[page] for page in pages)
    told = set(re.findall(r"\.\. auto(?:function|class|data):: (?:\w+\.)*(\w+)", text))
    assert set(importlib.import_module(package).__all__) - ROOMS <= told


def test_every_option_of_a_command_in_the_pages_exists():
    from contvines.command.cli import COMMANDS, command

    options = {
        name: {"--help"}.union(*((*entry.opts, *entry.secondary_opts) for entry in command(name).params))
        for name in COMMANDS
    }
    seen = 0
    for text in ((TOP / "README.md").read_text(encoding="utf-8"), *PAGES.values()):
        code = re.findall(
            r"```sh\n(.*?)```|`(contvines [^`]+)`|^!(contvines .*)$", text, re.DOTALL | re.MULTILINE
        )
        lines = "\n".join(part for parts in code for part in parts)
        for verb, words in re.findall(
            r"^\s*(?:\.venv/bin/)?contvines ([a-z]+)\b([^#\n]*)", lines, re.MULTILINE
        ):
            used = re.findall(r"(?<![\w-])(--?[a-z][\w-]*)", words)
            assert set(used) <= options[verb], f"contvines {verb}{words}"
            seen += len(used)
    assert seen > 40
    rows = re.findall(r"^\| `(\w+)`(.*)$", PAGES["reference"], re.MULTILINE)
    assert {verb for verb, _ in rows} == set(COMMANDS)
    for verb, row in rows:
        assert set(re.findall(r"`[^`]*?(?<![\w-])(--?[a-z][\w-]*)", row)) <= options[verb], verb


def test_the_sketches_are_those_that_the_code_draws(tmp_path):
    spec = importlib.util.spec_from_file_location("pictures", DOCS / "pictures.py")
    pictures = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(pictures)
    drawn = {path.name for path in pictures.draw_all(tmp_path)}
    assert drawn == {path.name for path in (DOCS / "concepts").iterdir()}
    assert drawn == set(re.findall(r"\(concepts/(\w+\.png)\)", "\n".join(PAGES.values())))


def test_every_example_has_its_picture_in_the_gallery(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS))
    listed = importlib.import_module("gallery_pages").listed()
    assert {one.name for one in listed} == {path.stem for path in (DOCS / "gallery").glob("*.png")}
    assert {path.stem for path in TOP.glob("examples/*/*.toml")} <= {one.path.stem for one in listed}


@pytest.mark.parametrize("name", PAGES)
def test_pages_are_short_and_code_is_not_cut(name):
    assert PAGES[name].count("\n") <= 210
    code = re.findall(r"```(?:\{code-cell\} ipython3|python|toml)\n(.*?)```", PAGES[name], re.DOTALL)
    assert max(map(len, "\n".join(code).split("\n"))) <= 120


@pytest.mark.parametrize("pages", ["docs/**/*.md", "*.md", "examples/**/*.md"])
def test_rows_of_tables_have_as_many_cells_as_their_heading(pages):
    """A cell that is left out moves all that follow it under wrong headings."""
    for page in TOP.glob(pages):
        width = None
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            bars = len(re.findall(r"(?<!\\)\|", line)) if line.startswith("|") else None
            assert width is None or bars in (None, width), f"{page.name}, line {number}"
            width = bars
