"""A server on an empty folder."""

import threading

import pytest

from faying.app.project import Project
from faying.app.server import Server


@pytest.fixture
def server(tmp_path):
    server = Server(Project.at(tmp_path))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield server
    server.shutdown()
    thread.join()
    server.close()
