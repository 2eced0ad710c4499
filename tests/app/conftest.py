"""A server on an empty folder."""

import pytest

from faying.app.project import Project
from faying.app.server import Server


@pytest.fixture
def server(tmp_path):
    server = Server(Project.at(tmp_path))
    thread = server.run_in_thread()
    yield server
    server.shutdown()
    thread.join()
    server.close()
