"""The documentation as a site: `sphinx-build -W docs docs/_build` with the extra `docs` installed; it runs the notebooks."""

import os
import sys

project = "contvines"
author = "The contvines developers"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "numpydoc"]
exclude_patterns = ["_build"]
html_theme = "alabaster"
html_theme_options = {
    "page_width": "1120px",
    "sidebar_width": "230px",
    "body_max_width": "860px",
    "fixed_sidebar": True,
}
html_extra_path = ["study.schema.json"]
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]

# notebooks are pages of Markdown whose cells the build runs; a cell that fails, fails the build
os.environ["PATH"] = os.pathsep.join(
    [os.path.dirname(sys.executable), os.environ.get("PATH", "")]
)  # cells call `contvines`
os.environ["CONTVINES_PROGRESS"] = "off"  # pages show results, not the way to them
nb_execution_mode = "auto"
nb_execution_in_temp = True
nb_execution_timeout = 240
nb_execution_raise_on_error = True
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings have shapes and units
numpydoc_show_class_members = False
