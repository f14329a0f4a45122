"""Pictures that an example of the gallery writes stand below the code that wrote them."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any


def written_pictures(block: object, variables: dict[str, Any], settings: dict[str, Any]) -> str:
    """Return the text that shows PNG files beside the example, which are moved to the gallery; Sphinx-Gallery calls it.

    Args:
        block: of the example that has just run.
        variables: of the example: its file, and the names that the gallery has for images.
        settings: of the gallery.
    """
    from sphinx_gallery.scrapers import figure_rst

    shown = []
    for file in sorted(Path(variables["src_file"]).parent.glob("*.png")):
        shown.append(next(variables["image_path_iterator"]))
        shutil.move(file, shown[-1])
    return str(figure_rst(shown, settings["src_dir"]))
