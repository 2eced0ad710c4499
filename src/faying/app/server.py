"""The server of the page: on 127.0.0.1 alone, behind a token in the address, for requests of its own page alone."""

import hmac
import secrets
import sys
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, unquote, urlsplit

from faying.app.project import LARGEST, Project
from faying.app.routes import Request, Session, answered
from faying.errors import InputError
from faying.output.scene.pages import ASSETS as VIEWER

ADDRESS = "127.0.0.1"
# what the page may load: itself; the report inside it may run its own scripts, in an origin that is nobody's
PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
    "frame-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
RESULT_POLICY = (
    "sandbox allow-scripts allow-downloads; default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data: blob:; frame-ancestors 'self'; base-uri 'none'; form-action 'none'"
)
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".csv": "text/csv; charset=utf-8",
}
DIGITS = 18  # of the length of a request, beyond which it is not a size
PAGE = Path(__file__).parent / "page"
OWN = ("app.css", "app.js", "base.js", "explore.js", "form.js", "runs.js")
# the page's files by their name in the address, "" for the page itself
ASSETS = {"": PAGE / "index.html", **{name: PAGE / name for name in OWN}, **VIEWER}


class Server(ThreadingHTTPServer):
    """Serves one project until it is shut down.

    Args:
        project: The folder that the page works on.
        port: On which to listen; 0 takes a free one.
    """

    daemon_threads = True
    request_queue_size = 256  # connections that wait: a browser opens six to a page, several pages at once many

    def __init__(self, project: Project, port: int = 0) -> None:
        self.session, self.token = Session(project), secrets.token_urlsafe(24)
        try:
            super().__init__((ADDRESS, port), _Handler)
        except OSError as fault:
            raise InputError(f"cannot listen on port {port}: {fault.strerror}; leave out --port") from None
        self.origins = {f"http://{name}:{self.server_port}" for name in (ADDRESS, "localhost")}

    @property
    def address(self) -> str:
        """Where the page is; whoever knows it may use it."""
        return f"http://{ADDRESS}:{self.server_port}/{self.token}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a page that was closed while it was being answered; show every other fault."""
        if not isinstance(sys.exc_info()[1], ConnectionError | TimeoutError):
            super().handle_error(request, client_address)

    def close(self) -> None:
        """Stop the job that runs, and listen no more."""
        self.session.close()
        self.server_close()


class _Handler(BaseHTTPRequestHandler):
    """One request: who asks, how much it sends, then the answer."""

    protocol_version = "HTTP/1.1"
    timeout = 60.0  # s without a byte
    server: Server
    server_version, sys_version = "Faying", ""

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing: the terminal belongs to the user."""

    def _serve(self) -> None:
        try:
            url = urlsplit(self.path)
        except ValueError as fault:  # such as half of an address of IPv6
            self._refuse(400, f"the address is not one ({fault})")
            return
        refusal = self._refusal(url.path)
        if refusal is not None:
            self._refuse(*refusal)
            return
        path = url.path.removeprefix(f"/{self.server.token}/")
        size = int(self.headers.get("Content-Length") or 0)
        request = Request(query=dict(parse_qsl(url.query, keep_blank_values=True)), body=self.rfile, size=size)
        if path.startswith("api/"):
            found = answered(self.server.session, self.command, path.removeprefix("api/"), request)
            if found is None:
                self._refuse(404, "there is no file or address of this name")
            else:
                self.close_connection = self.close_connection or bool(size)  # what was not read is not a request
                self._send(200, "application/json", found, PAGE_POLICY)
        elif self.command != "GET":
            self._refuse(405, "only api/ takes anything")
        elif path.startswith("results/"):
            self._send_result(unquote(path.removeprefix("results/")))
        else:
            self._send_asset(path)

    do_GET = do_POST = do_PUT = do_DELETE = _serve

    def _refusal(self, path: str) -> tuple[int, str] | None:
        """Status and reason where a request is not one of the page's own; None where it is."""
        if f"http://{self.headers.get('Host', '')}" not in self.server.origins:
            return 403, "the Host of the request is not this server"
        origin, site = self.headers.get("Origin"), self.headers.get("Sec-Fetch-Site", "none")
        if (origin is not None and origin not in self.server.origins) or site not in ("none", "same-origin"):
            return 403, "the request comes from another page"
        token = path.split("/")[1:2]
        if not token or not hmac.compare_digest(token[0].encode(), self.server.token.encode()):
            return 403, "the address lacks the token; open the address that faying app printed"
        if path == f"/{self.server.token}":
            return 404, "the address ends in /"
        if "Transfer-Encoding" in self.headers:
            return 411, "send a Content-Length"
        length = self.headers.get("Content-Length", "0")
        if not (length.isascii() and length.isdigit()):
            return 400, "the Content-Length is not a number"
        if len(length) > DIGITS or int(length) > LARGEST:
            return 413, f"a file may have {LARGEST >> 30} GB at most; put larger ones into the folder yourself"
        return None

    def _refuse(self, status: int, why: str) -> None:
        self.close_connection = True
        self._send(status, "text/plain; charset=utf-8", why.encode(), PAGE_POLICY)

    def _send_result(self, name: str) -> None:
        try:
            path = self.server.session.project.result(name)
        except InputError as fault:
            self._refuse(404, str(fault))
            return
        try:
            data = path.read_bytes()
        except OSError as fault:  # it went away, or was never to be read
            self._refuse(404, f"{path.name} cannot be read ({fault.strerror})")
            return
        self._send(200, TYPES.get(path.suffix, "application/octet-stream"), data, RESULT_POLICY)

    def _send_asset(self, name: str) -> None:
        if name not in ASSETS:
            self._refuse(404, "there is no file or address of this name")
            return
        file = ASSETS[name]
        self._send(200, TYPES[file.suffix], file.read_bytes(), PAGE_POLICY)

    def _send(self, status: int, kind: str, body: bytes, policy: str) -> None:
        self.send_response(status)
        for name, value in (
            ("Content-Type", kind),
            ("Content-Length", str(len(body))),
            ("Content-Security-Policy", policy),
            ("Cache-Control", "no-store"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Content-Type-Options", "nosniff"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
            ("Cross-Origin-Opener-Policy", "same-origin"),
        ):
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(body)
