"""Serve one page to this machine's browser until the user has seen enough.

The page is complete in itself, so a server need only hand it out: it lives in the process that shows it, on the
loopback interface, and there is no child that could outlive it.
"""

from __future__ import annotations

import errno
import socket
import webbrowser
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

FIRST_PORT, PORTS = 7000, 100
HOST = "127.0.0.1"


class PageServer(ThreadingHTTPServer):
    """Serves ``page`` at its root; a port that is taken is stepped over.

    Args:
        page: HTML text.
        port: the first one to try.
        handler: answers the requests.

    Raises:
        OSError: no port from there on, nor any other, can be had.
    """

    daemon_threads = True
    block_on_close = False

    def __init__(self, page: str, port: int = FIRST_PORT, handler: type[PageHandler] | None = None) -> None:
        self.page = page.encode("utf-8")
        super().__init__((HOST, port), handler or PageHandler, bind_and_activate=False)
        try:
            self._bind_from(port)
            self.server_activate()
        except OSError:
            self.server_close()
            raise

    @property
    def url(self) -> str:
        """Where the page is."""
        return f"http://{HOST}:{self.server_address[1]}/"

    def _bind_from(self, first: int) -> None:
        # The last candidate, 0, lets the system choose.
        for port in [*range(first, min(first + PORTS, 65536)), 0]:
            self.server_address = (HOST, port)
            try:
                self.server_bind()
                return
            except OSError as error:
                if error.errno not in (errno.EADDRINUSE, errno.EACCES) or port == 0:
                    raise

    def server_bind(self) -> None:
        """Bind, and leave out the reverse look-up of the host's name, which can take seconds."""
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.bind(self.server_address)
        self.server_address = self.socket.getsockname()
        self.server_name, self.server_port = HOST, self.server_address[1]


class PageHandler(BaseHTTPRequestHandler):
    """Hands out the page at the root, and nothing else."""

    server: PageServer

    def do_GET(self) -> None:
        """Answer with the page."""
        self._answer(with_body=True)

    def do_HEAD(self) -> None:
        """Answer with the page's headers."""
        self._answer(with_body=False)

    def _answer(self, *, with_body: bool) -> None:
        if self.path.split("?")[0] != "/":
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Content-Length", str(len(self.server.page)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        if with_body:
            self.wfile.write(self.server.page)

    def log_message(self, format: str, *args: object) -> None:
        """Stay silent: the terminal belongs to the command."""


def opened(url: str) -> bool:
    """Return whether a browser with windows was started; one in the terminal would show nothing, and would block."""
    try:
        browser = webbrowser.get()
    except webbrowser.Error:
        return False
    return type(browser) is not webbrowser.GenericBrowser and browser.open(url)
