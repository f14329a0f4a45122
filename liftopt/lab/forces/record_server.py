"""The page of a recording, on the loopback interface: live readings out, the buttons in."""

from __future__ import annotations

import json
import sys
from http import HTTPStatus
from importlib.resources import files
from typing import Any
from urllib.parse import parse_qs, urlsplit

from liftopt.lab.forces.record_session import RecordSession
from liftopt.viz.viewer_server import PageHandler, PageServer


class RecordServer(PageServer):
    """Serves the page of a session.

    Args:
        session: the recording.

    Raises:
        OSError: no port can be had.
    """

    def __init__(self, session: RecordSession) -> None:
        self.session = session
        page = (files("liftopt.lab.forces") / "pages" / "record.html").read_text(encoding="utf-8")
        super().__init__(page, handler=_RecordHandler)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a page that was closed while it was answered."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)


class _RecordHandler(PageHandler):
    server: RecordServer

    def do_GET(self) -> None:
        url = urlsplit(self.path)
        if url.path != "/live":
            super().do_GET()
            return
        after = parse_qs(url.query).get("after", ["0"])[0]
        if not self._is_ours() or not after.isdecimal() or len(after) > 15:
            self.send_error(HTTPStatus.BAD_REQUEST)
            return
        self._send(HTTPStatus.OK, self.server.session.live(int(after)))

    def do_POST(self) -> None:
        session = self.server.session
        buttons = {"/start": session.start, "/stop": session.stop, "/preload": session.preload}
        if self.path not in buttons:
            self.send_error(HTTPStatus.NOT_FOUND)
        elif not self._is_ours():
            self.send_error(HTTPStatus.FORBIDDEN)
        else:
            refusal = buttons[self.path]()
            self._send(HTTPStatus.CONFLICT if refusal else HTTPStatus.OK, {"refusal": refusal})

    def _is_ours(self) -> bool:
        """Return whether the request is for this address and from its page: other sites may not press the buttons."""
        origin = self.headers.get("Origin", self.server.url.rstrip("/"))
        return f"http://{self.headers.get('Host')}/" == self.server.url and f"{origin}/" == self.server.url

    def _send(self, status: HTTPStatus, answer: dict[str, object]) -> None:
        body = json.dumps(answer, allow_nan=False).encode("utf-8")
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(body)
