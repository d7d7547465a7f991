"""The documentation as a site: `sphinx-build -W docs site` with the extra `docs` installed; it runs the notebooks."""

import os
import re
import shutil
import sys
from importlib.metadata import metadata
from pathlib import Path

import contvines

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import gallery_pages  # noqa: E402

project = "contvines"
author = metadata("contvines")["Author"] or metadata("contvines")["Author-email"]
project_copyright = author
release = version = contvines.__version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "numpydoc", "sphinx_copybutton"]
exclude_patterns = ["_build"]

highlight_language = "none"  # what a command prints is no Python; blocks of code name their language
html_theme = "furo"
html_title = f"contvines {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_extra_path = ["study.schema.json"]
html_show_sourcelink = False
copybutton_prompt_text = r"\$ |>>> "
copybutton_prompt_is_regexp = True

myst_heading_anchors = 3
myst_enable_extensions = ["html_image"]  # pictures of a stated width

# notebooks are pages of Markdown whose cells the build runs; a cell that fails, fails the build
os.environ["PATH"] = os.pathsep.join(
    [os.path.dirname(sys.executable), os.environ.get("PATH", "")]
)  # cells call `contvines`
os.environ["CONTVINES_DOCS"] = str(HERE)
os.environ["COLUMNS"] = "104"  # printed tables are as wide as a page
os.environ["CONTVINES_PROGRESS"] = "off"  # pages show results, not the way to them
nb_execution_mode = "auto"
nb_execution_in_temp = True
nb_execution_timeout = 240
nb_execution_raise_on_error = True
nb_merge_streams = True

autodoc_preserve_defaults = True  # as the source writes them
nitpicky = True  # a cross reference that leads nowhere fails the build
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings have shapes and units
numpydoc_show_class_members = False

linkcheck_timeout = 20
linkcheck_anchors = False  # of pages elsewhere; those of this site are checked by the build

# pages of the examples, with their pictures beside them
gallery_pages.write(HERE / "gallery")


def setup(app):
    """Pictures that the grid of the gallery shows by their place on the site, and signatures that can be read."""

    def copy(app, problem):
        if problem is None and app.builder.format == "html":
            shutil.copytree(
                HERE / "gallery",
                Path(app.outdir) / "_static" / "gallery",
                ignore=shutil.ignore_patterns("*.md"),
                dirs_exist_ok=True,
            )

    def plain(app, what, name, obj, options, signature, returns):
        """A class with many fields, or with defaults that are objects, is read below its name, not in it."""
        if what != "class" or not signature:
            return None
        if name.endswith("Settings"):  # its defaults are worth reading
            return re.sub(r"StepRule\(judge=.*?\)", "StepRule(by_angle)", signature), returns
        return ("", None) if len(signature) > 300 or "<" in signature else None

    def own(app, what, name, obj, options, lines):
        """Of data, what the page says of it, not what Python says of its class."""
        if what == "data":
            lines.clear()

    app.connect("build-finished", copy)
    app.connect("autodoc-process-signature", plain)
    app.connect("autodoc-process-docstring", own)
