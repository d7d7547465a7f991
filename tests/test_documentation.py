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


@pytest.mark.long
def test_the_site_builds_without_a_warning(tmp_path):
    pytest.importorskip("sphinx")
    pytest.importorskip("myst_nb")
    pytest.importorskip("numpydoc")
    line = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", str(DOCS), str(tmp_path / "site")]
    done = subprocess.run(line, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    assert (tmp_path / "site/concepts.html").exists()
    assert (tmp_path / "site/_static/gallery/henon.png").exists()


def test_every_page_is_in_the_contents():
    contents = (DOCS / "index.md").read_text(encoding="utf-8")
    listed = "\n".join(re.findall(r"```\{toctree\}(.*?)```", contents, re.DOTALL))
    pages = {path.stem for path in DOCS.glob("*.md")} - {"index"}
    assert pages == set(re.findall(r"^(\w+)$", listed, re.MULTILINE))


def test_every_link_of_a_page_leads_somewhere_on_the_site():
    # a page of the site, or a file that the site copies; a folder, or a page of Markdown elsewhere, would be a dead link
    seen = 0
    for page in DOCS.glob("*.md"):
        for target in re.findall(r"\]\((?!\w+:|#|gallery/index)([^)#]+)", page.read_text(encoding="utf-8")):
            seen += 1
            path = (page.parent / target).resolve()
            assert path.is_file(), f"{page.name}: {target}"
            assert path.suffix != ".md" or path.parent == DOCS, f"{page.name}: {target}"
    assert seen > 30


def test_the_labels_in_the_first_study_are_those_of_its_graph():
    text = (DOCS / "first_study.md").read_text(encoding="utf-8")
    cells = re.findall(r"```\{code-cell\} ipython3\n(.*?)```", text, re.DOTALL)
    names: dict = {}
    for cell in cells[: 1 + next(i for i, cell in enumerate(cells) if "cv.diagram(" in cell)]:
        if ".plot(" not in cell:
            exec(cell, names)
    labels = set(re.findall(r"`([A-Z]{2}\d+)`", text)) | set(re.findall(r'graph\["(\w+)"\]', text))
    assert len(labels) >= 5
    assert not [label for label in labels if label not in names["graph"]]


def test_every_public_name_is_in_the_reference():
    general, problems, machines = (
        (DOCS / f"python{page}.md").read_text(encoding="utf-8") for page in ("", "_problems", "_machines")
    )
    rooms = {
        "attractors",
        "design",
        "machines",
        "multiple_scales",
        "simulation",
        "symbols",
        "theory",
        "words",
    }
    for package, part in (("contvines", general + problems), ("orbits", machines)):
        names = set(importlib.import_module(package).__all__) - rooms
        assert names <= set(re.findall(r"\.\. auto(?:function|class|data):: (?:\w+\.)*(\w+)", part)), package


def test_every_option_of_a_command_in_the_pages_exists():
    from contvines.command.cli import COMMANDS, command

    options = {
        name: {text for entry in command(name).params for text in (*entry.opts, *entry.secondary_opts)}
        | {"--help"}
        for name in COMMANDS
    }
    seen = 0
    for page in (DOCS.parent / "README.md", *sorted(DOCS.glob("*.md"))):
        code = re.findall(
            r"```sh\n(.*?)```|`(contvines [^`]+)`|^!(contvines .*)$",
            page.read_text(encoding="utf-8"),
            re.DOTALL | re.MULTILINE,
        )
        for line in "\n".join(part for parts in code for part in parts if part).splitlines():
            match = re.match(r"(?:\.venv/bin/)?contvines ([a-z]+)\b([^#]*)", line.strip())
            if match is None:
                continue
            assert match[1] in options, f"{page.name}: {line}"
            for option in re.findall(r"(?<![\w-])(--?[a-z][\w-]*)", match[2]):
                seen += 1
                assert option in options[match[1]], f"{page.name}: {line.strip()}: {option}"
    assert seen > 40
    rows = re.findall(r"^\| `(\w+)`(.*)$", (DOCS / "reference.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert {verb for verb, _ in rows} == set(COMMANDS)
    for verb, row in rows:
        assert set(re.findall(r"`[^`]*?(?<![\w-])(--?[a-z][\w-]*)", row)) <= options[verb], verb


def test_the_sketches_are_those_that_the_code_draws(tmp_path):
    spec = importlib.util.spec_from_file_location("pictures", DOCS / "pictures.py")
    pictures = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(pictures)
    drawn = pictures.draw_all(tmp_path)
    assert sorted(p.name for p in drawn) == sorted(p.name for p in (DOCS / "concepts").iterdir())
    pages = "\n".join(page.read_text(encoding="utf-8") for page in DOCS.glob("*.md"))
    assert {p.name for p in drawn} == set(re.findall(r"\(concepts/(\w+\.png)\)", pages))


def test_every_example_has_its_picture_in_the_gallery(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS))
    listed = importlib.import_module("gallery_pages").listed()
    assert {one.name for one in listed} == {path.stem for path in (DOCS / "gallery").glob("*.png")}
    shown = {one.path.stem for one in listed}
    for path in (DOCS.parent / "examples").glob("*/*.toml"):
        assert path.stem in shown, path


def test_pages_are_short_and_code_is_not_cut():
    for page in DOCS.glob("*.md"):
        text = page.read_text(encoding="utf-8")
        assert text.count("\n") <= 210, page.name
        for code in re.findall(r"```(?:\{code-cell\} ipython3|python|toml)\n(.*?)```", text, re.DOTALL):
            assert max(map(len, code.splitlines())) <= 120, page.name


@pytest.mark.parametrize("page", sorted(path.name for path in DOCS.glob("*.md")))
def test_pictures_and_links_of_the_pages_exist(page):
    text = (DOCS / page).read_text(encoding="utf-8")
    for target in re.findall(r"\]\(((?!http|gallery/index)[^)#]+)\)", text):
        assert (DOCS / target).exists(), target


@pytest.mark.parametrize(
    "folder", [DOCS, DOCS.parent, DOCS.parent / "examples"], ids=lambda folder: folder.name
)
def test_rows_of_tables_have_as_many_cells_as_their_heading(folder):
    """A cell that is left out moves all that follow it under wrong headings."""
    for page in folder.glob("**/*.md" if folder != DOCS.parent else "*.md"):
        width = None
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            bars = len(re.findall(r"(?<!\\)\|", line)) if line.startswith("|") else None
            assert width is None or bars in (None, width), f"{page.name}, line {number}"
            width = bars
