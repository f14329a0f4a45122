"""How the documentation is built: ``sphinx-build -W --keep-going -b html docs docs/_build``, without a network.

Drawings, tables of keys and the gallery are made anew from the code at each build.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))  # drawings, tables, mathml, pictures

import liftopt  # noqa: E402
from pictures import written_pictures  # noqa: E402

project = "liftopt"
version = release = liftopt.__version__
extensions = ["sphinx.ext.autodoc", "sphinx.ext.napoleon", "myst_parser", "sphinx_gallery.gen_gallery", "mathml"]
exclude_patterns = ["_build", "_drawings", "_tables", "drawings", "tables", "gallery/*.ipynb", "gallery/*.py"]
suppress_warnings = ["config.cache"]  # the gallery's settings hold a function

html_theme = "furo"
html_title = "liftopt"
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False
html_static_path = ["static"]
html_css_files = ["formula.css"]
myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_default_options = {"exclude-members": "model_config, refusal, __init__"}
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"

sphinx_gallery_conf = {
    "examples_dirs": ["../scripts/examples"],
    "gallery_dirs": ["gallery"],
    "filename_pattern": r"\.py$",
    "within_subsection_order": "tables.gallery_place",
    "image_scrapers": ("matplotlib", written_pictures),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_signature": False,
    "remove_config_comments": True,
    "capture_repr": (),
    "write_computation_times": False,
    "reset_modules": (),
}


def _make_sources(app: Any) -> None:
    from drawings import write_drawings
    from tables import write_tables

    write_drawings(HERE / "_drawings")
    write_tables(HERE / "_tables")


def setup(app: Any) -> None:
    """Make drawings and tables before Sphinx looks for its sources."""
    app.connect("config-inited", lambda app, config: _make_sources(app))
