"""An answer as one page that reads on paper: a headline, sentences, pictures, tables, lists."""

from __future__ import annotations

import html
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")
PATIENCE = 120.0  # seconds for a browser to print a page

Rows = Sequence[Sequence[str]]


@dataclass(frozen=True)
class Answer:
    """What stands on the page, in order.

    Attributes
    ----------
    title, headline : str
    sentences : list of str
    pictures : list of (Figure, caption)
    tables : list of (title, rows)
    lists : list of (title, sentences)
    footer : str
    """

    title: str
    headline: str
    sentences: list[str]
    pictures: list[tuple[Figure, str]] = field(default_factory=list)
    tables: list[tuple[str, Rows]] = field(default_factory=list)
    lists: list[tuple[str, list[str]]] = field(default_factory=list)
    footer: str = ""

    def page(self) -> str:
        """The HTML text; pictures are in it."""
        say = html.escape
        parts = [
            f'<p class="answer">{say(self.headline)}</p>',
            *(f"<p>{say(text)}</p>" for text in self.sentences),
        ]
        parts += [
            f"<figure>{_svg(figure)}<figcaption>{say(text)}</figcaption></figure>"
            for figure, text in self.pictures
        ]
        parts.append('<div class="columns">')
        for title, rows in self.tables:
            body = "".join(
                "<tr>" + "".join(f"<td>{say(cell)}</td>" for cell in row) + "</tr>" for row in rows
            )
            parts.append(f"<section><h2>{say(title)}</h2><table>{body}</table></section>")
        for title, sentences in self.lists:
            body = "".join(f"<li>{say(text)}</li>" for text in sentences)
            parts.append(f"<section><h2>{say(title)}</h2><ul>{body}</ul></section>")
        parts.append("</div>")
        text = files("contvines.report").joinpath("answer.html").read_text(encoding="utf-8")
        for name, part in {
            "TITLE": say(self.title),
            "FOOTER": say(self.footer),
            "BODY": "\n".join(parts),
        }.items():
            text = text.replace(f"<!--{name}-->", part)
        return text


def _svg(figure: Figure) -> str:
    """A figure as SVG that stands inside a page."""
    stream = StringIO()
    figure.savefig(stream, format="svg")
    text = stream.getvalue()
    return text[text.index("<svg") :]


def print_page(page: str | Path, target: str | Path) -> str:
    """Print a page as PDF with the browser of this computer, whose name is returned.

    Raises
    ------
    ValueError
        If there is no browser that can, or it fails.
    """
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        raise ValueError(
            f"{target}: no browser is found that prints pages ({', '.join(BROWSERS)}); open {page} in any browser and print it there."
        )
    place = Path(target).absolute()
    with tempfile.TemporaryDirectory() as profile:
        options = (
            "--headless",
            "--disable-gpu",
            "--no-sandbox",
            "--no-pdf-header-footer",
            f"--user-data-dir={profile}",
        )
        command = [
            browser,
            *options,
            "--virtual-time-budget=20000",
            f"--print-to-pdf={place}",
            Path(page).absolute().as_uri(),
        ]
        try:
            subprocess.run(command, check=True, capture_output=True, timeout=PATIENCE)
        except (subprocess.SubprocessError, OSError) as error:
            raise ValueError(
                f"{target}: {browser} could not print the page ({type(error).__name__}); open {page} and print it there."
            ) from None
    return Path(browser).name
