"""``liftopt view``: a result, or two, in the browser or in a file to send."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.interrupt import interrupts
from liftopt.types import Progress
from liftopt.viz.viewer_server import FIRST_PORT, PageServer, opened

if TYPE_CHECKING:
    from liftopt.viz.own_meshes import Meshes


def view(
    result: str | Path,
    *,
    other: str | Path | None = None,
    ghost: bool = False,
    html: str | Path | None = None,
    sawyer: str | Path | None = None,
    meshes: Meshes = False,
    port: int = FIRST_PORT,
    browser: bool = True,
    progress: Progress = print,
) -> None:
    """Play a result in the browser until Ctrl-C, or write the playback to a file.

    Args:
        result: folder that ``liftopt solve`` wrote, or its ``solution.nc``.
        other: a second result, shown beside the first.
        ghost: show the second one see-through in the first one's place.
        html: file to write the page to; then nothing is served.
        sawyer: the manufacturer's ``sawyer_description`` folder, for its meshes in place of our primitives.
        meshes: where other robots' own meshes are looked for, as ``figures_of`` has it.
        port: first port to try.
        browser: open the page in the user's browser.
        progress: where to tell the user about the page.

    Raises:
        InputError: a result cannot be read, or the file cannot be written; it says which and why.
    """
    if ghost and other is None:
        raise InputError("--ghost", NO_VALUE, "needs a second result: add --with OTHER")
    if not 0 <= port <= 65535:
        raise InputError("--port", port, "must be from 0 to 65535")
    with interrupts() as found:
        page = _page(result, other, ghost, sawyer, meshes)
        found.check()  # trimesh swallows one while it tries its imports
    if html is not None:
        _write(Path(html), page)
        progress(f"Written to {html}: {len(page.encode('utf-8')) / 1e6:.1f} MB, complete in itself")
        return
    with PageServer(page, port) as server, suppress(KeyboardInterrupt):
        progress(f"Playing at {server.url} (Ctrl-C ends it)")
        if browser and not opened(server.url):
            progress("No browser could be opened here: open this address in one.")
        server.serve_forever(poll_interval=0.2)


def _page(result: str | Path, other: str | Path | None, ghost: bool, sawyer: str | Path | None, meshes: Meshes) -> str:
    from liftopt.storage.reader import load_result
    from liftopt.viz.viewer_page import playback_page

    second = None if other is None else load_result(other)
    return playback_page(load_result(result), second, ghost=ghost, sawyer=sawyer, meshes=meshes)


def _write(file: Path, page: str) -> None:
    try:
        file.write_text(page, encoding="utf-8")
    except OSError as error:
        raise InputError("--html", str(file), f"cannot be written: {error.strerror or error}") from None
