"""A real browser for the pages: Chromium without a screen, driven by Playwright."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--no-sandbox",  # the tests may run as root, where Chromium refuses its sandbox
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-quic",
    "--disable-sync",
    "--no-first-run",
)
SIZE = {"width": 800, "height": 500}
PATIENCE = 60_000  # [ms]


@dataclass
class Opened:
    """A page in the browser, with what it complained about and what it asked for."""

    page: Any
    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def run(self, script: str) -> Any:
        """Return the value of a JavaScript expression."""
        return self.page.evaluate(script)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """A headless Chromium of the system."""
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip(f"no browser to test the pages with: none of {', '.join(NAMES)} is installed")
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed (extra 'test')")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, headless=True, args=list(FLAGS))
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def open_page(chromium: Any) -> Callable[[str | Path], Opened]:
    """Return a function that loads a file or an address and waits until the playback is ready."""

    def open_(where: str | Path) -> Opened:
        opened = Opened(chromium.new_page(viewport=SIZE))
        opened.page.set_default_timeout(PATIENCE)
        opened.page.on("pageerror", lambda error: opened.complaints.append(str(error)))
        opened.page.on("console", lambda m: opened.complaints.append(m.text) if m.type == "error" else None)
        opened.page.on("request", lambda request: opened.requests.append(request.url))
        opened.page.goto(where.as_uri() if isinstance(where, Path) else where)
        opened.page.wait_for_function("window.liftopt && window.liftopt.ready")
        return opened

    return open_
