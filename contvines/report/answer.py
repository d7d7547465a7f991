"""An answer for paper (headline, sentences, pictures, tables, lists), as an HTML page printed by a browser, or as PDF set by matplotlib."""

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
    from matplotlib.backends.backend_pdf import PdfPages
    from matplotlib.figure import Figure


BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")
PATIENCE = 120.0  # seconds that a browser may take to print a page

Rows = Sequence[Sequence[str]]
WIDE, HIGH = 595.0, 842.0  # points: A4
MARGIN = 42.0
ROOM = WIDE - 2.0 * MARGIN
LEADING = 1.32  # distance of lines, relative to the font size
BODY, SMALL, HEAD, TITLE = 9.0, 8.0, 10.5, 14.0  # points: font sizes
COLUMNS = (0.0, 0.31, 0.5)  # left edges of a table's columns, relative to the text width
BLUE, GREY = "#0b3c6f", "0.35"
SHARP = 220  # dots per inch of pictures


@dataclass(frozen=True)
class Answer:
    """The contents of the page, in order.

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
        """Return the HTML text, with the pictures embedded as SVG."""
        escaped = html.escape
        parts = [
            f'<p class="answer">{escaped(self.headline)}</p>',
            *(f"<p>{escaped(text)}</p>" for text in self.sentences),
        ]
        parts += [
            f"<figure>{_svg(figure)}<figcaption>{escaped(text)}</figcaption></figure>"
            for figure, text in self.pictures
        ]
        parts.append('<div class="columns">')
        for title, rows in self.tables:
            body = "".join(
                "<tr>" + "".join(f"<td>{escaped(cell)}</td>" for cell in row) + "</tr>" for row in rows
            )
            parts.append(f"<section><h2>{escaped(title)}</h2><table>{body}</table></section>")
        for title, sentences in self.lists:
            body = "".join(f"<li>{escaped(text)}</li>" for text in sentences)
            parts.append(f"<section><h2>{escaped(title)}</h2><ul>{body}</ul></section>")
        parts.append("</div>")
        text = files("contvines.report").joinpath("answer.html").read_text(encoding="utf-8")
        for name, part in {
            "TITLE": escaped(self.title),
            "FOOTER": escaped(self.footer),
            "BODY": "\n".join(parts),
        }.items():
            text = text.replace(f"<!--{name}-->", part)
        return text


def _svg(figure: Figure) -> str:
    """Return a figure as an SVG element for embedding in HTML."""
    stream = StringIO()
    figure.savefig(stream, format="svg")
    text = stream.getvalue()
    return text[text.index("<svg") :]


def print_page(page: str | Path, target: str | Path) -> str:
    """Print a page as PDF with a browser installed on this computer (one of `BROWSERS`); return the browser's name.

    Raises
    ------
    ValueError
        If there is no such browser, or it fails.
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


def set_answer(answer: Answer, target: str | Path) -> None:
    """Write an answer as PDF: headline, sentences and pictures on the first sheet, tables and lists on the next.

    Parameters
    ----------
    answer : Answer
    target : str or Path
    """
    from matplotlib.backends.backend_pdf import PdfPages

    with PdfPages(target, metadata={"Title": answer.title}) as pages:
        sheet = _Sheet(pages)
        sheet.text(answer.title, TITLE, weight="bold")
        sheet.text(answer.headline, HEAD + 1.0, weight="bold", color=BLUE)
        for sentence in answer.sentences:
            sheet.text(sentence)
        for figure, caption in answer.pictures:
            sheet.picture(figure)
            sheet.text(caption, SMALL, color=GREY)
        for title, rows in answer.tables:
            sheet.head(title, len(rows))
            for row in rows:
                sheet.row(row)
        for title, sentences in answer.lists:
            sheet.head(title, 1)
            for sentence in sentences:
                sheet.text(f"\N{BULLET} {sentence}", SMALL)
        sheet.gap(BODY)
        sheet.text(answer.footer, SMALL, color=GREY)
        sheet.close()


class _Sheet:
    """A4 sheets of a PDF, filled from top to bottom."""

    def __init__(self, pages: PdfPages) -> None:
        from matplotlib.textpath import TextToPath

        self.pages, self.measuring = pages, TextToPath()
        self._begin()

    def _begin(self) -> None:
        from contvines.shared.figures import new_figure

        self.figure = new_figure(figsize=(WIDE / 72.0, HIGH / 72.0))
        # height of the free part's upper edge above the sheet's lower edge, in points
        self.below = HIGH - MARGIN

    def close(self) -> None:
        """Write the current sheet to the PDF."""
        self.pages.savefig(self.figure)

    def turn(self) -> None:
        """Write the current sheet and begin a new one."""
        self.close()
        self._begin()

    def gap(self, height: float) -> None:
        """Reserve vertical space, on a new sheet if this one is full."""
        if self.below - height < MARGIN:
            self.turn()
        self.below -= height

    def _wrapped(self, text: str, size: float, room: float, weight: str) -> list[str]:
        """Break a text into lines no wider than `room`."""
        from matplotlib.font_manager import FontProperties

        font, lines = FontProperties(size=size, weight=weight), [""]
        for word in text.split():
            longer = f"{lines[-1]} {word}".strip()
            if lines[-1] and self.measuring.get_text_width_height_descent(longer, font, False)[0] > room:
                lines.append(word)
            else:
                lines[-1] = longer
        return lines

    def _line(
        self, text: str, left: float, size: float, weight: str = "normal", color: str = "black"
    ) -> None:
        self.figure.text(
            (MARGIN + left) / WIDE, self.below / HIGH, text, size=size, weight=weight, color=color, parse_math=False
        )  # fmt: skip

    def text(self, text: str, size: float = BODY, weight: str = "normal", color: str = "black") -> None:
        """Set a paragraph."""
        for line in self._wrapped(text, size, ROOM, weight):
            self.gap(LEADING * size)
            self._line(line, 0.0, size, weight, color)
        self.below -= 0.35 * size

    def head(self, title: str, rows: int) -> None:
        """Set a title with a rule below; title and the `rows` rows that follow are kept on one sheet if they fit."""
        from matplotlib.lines import Line2D

        needed = HEAD * 2.4 + rows * SMALL * 1.6
        if needed > self.below - MARGIN and needed < HIGH - 2.0 * MARGIN:
            self.turn()
        self.gap(HEAD * 1.9)
        self._line(title, 0.0, HEAD, "bold")
        self.below -= 0.4 * HEAD
        ends, height = (MARGIN / WIDE, 1.0 - MARGIN / WIDE), self.below / HIGH
        self.figure.add_artist(Line2D(ends, (height, height), color="0.6", lw=0.6))

    def row(self, cells: Sequence[str]) -> None:
        """Set a row of a table; long cells are broken into lines."""
        starts = [ROOM * part for part in COLUMNS[: len(cells)]]
        ends = [*starts[1:], ROOM]
        broken = [
            self._wrapped(cell, SMALL, end - start - SMALL, "normal") for cell, start, end in zip(cells, starts, ends)
        ]  # fmt: skip
        for k in range(max(map(len, broken))):
            self.gap(LEADING * SMALL)
            for lines, start in zip(broken, starts):
                if k < len(lines):
                    self._line(lines[k], start, SMALL)
        self.below -= 0.25 * SMALL

    def picture(self, figure: Figure) -> None:
        """Set a picture as wide as the text."""
        import numpy as np
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        figure.set_dpi(SHARP)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        dots = np.asarray(canvas.buffer_rgba())
        height = ROOM * dots.shape[0] / dots.shape[1]
        self.gap(height + BODY)
        axes = self.figure.add_axes((MARGIN / WIDE, self.below / HIGH, ROOM / WIDE, height / HIGH))
        axes.imshow(dots, aspect="auto")
        axes.axis("off")
