"""The documentation as a site: `sphinx-build -W docs docs/_build` with the extra `docs` installed."""

project = "contvines"
author = "The contvines developers"
extensions = ["myst_parser"]
exclude_patterns = ["_build"]
html_theme = "alabaster"
myst_heading_anchors = 3
suppress_warnings = ["myst.xref_missing"]  # links to the repository's own files stay links to files
