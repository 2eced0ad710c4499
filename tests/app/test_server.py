"""Who is let in, and what they cannot reach."""

import http.client
import json
import socket
from contextlib import ExitStack
from types import SimpleNamespace
from urllib.parse import quote

import pytest

from faying.app import routes
from faying.app.project import LARGEST, Project, checked_name
from faying.app.server import Server
from faying.errors import InputError


def ask(server, path, method="GET", body=None, headers=(), *, token=None):
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=10)
    given = {"Host": f"127.0.0.1:{server.server_port}"} | dict(headers)
    connection.request(method, f"/{server.token if token is None else token}/{path}", body=body, headers=given)
    answer = connection.getresponse()
    text = answer.read().decode()
    connection.close()
    return answer, text


def test_the_page_is_served_with_a_policy_that_allows_no_other_host(server):
    answer, text = ask(server, "")
    assert answer.status == 200
    assert text.startswith("<!doctype html>")
    policy = answer.getheader("Content-Security-Policy")
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "http" not in policy


@pytest.mark.parametrize("token", ["", "x", "../x", "%00"])
def test_a_wrong_token_is_refused(server, token):
    for path in ("", "api/project", "results/result.nc"):
        answer, text = ask(server, path, token=token)
        assert answer.status == 403, path
        assert "token" in text


def test_a_token_of_the_right_length_is_refused_too(server):
    assert ask(server, "", token="A" * len(server.token))[0].status == 403


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1", "127.0.0.1:1", "evil.example:{port}", ""])
def test_a_wrong_host_is_refused(server, host):
    """A name of somebody else that resolves to this machine (DNS rebinding)."""
    answer, text = ask(server, "api/project", headers={"Host": host.format(port=server.server_port)})
    assert answer.status == 403
    assert "Host" in text


@pytest.mark.parametrize("method", ["GET", "POST", "PUT", "DELETE"])
@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1"])
def test_a_foreign_origin_is_refused(server, method, origin):
    answer, _ = ask(server, "api/job", method, headers={"Origin": origin.format(port=server.server_port)})
    assert answer.status == 403


def test_a_request_that_another_site_started_is_refused(server):
    assert ask(server, "", headers={"Sec-Fetch-Site": "cross-site"})[0].status == 403


def test_the_own_origin_is_let_in(server):
    answer, text = ask(server, "api/project", headers={"Origin": f"http://127.0.0.1:{server.server_port}"})
    assert answer.status == 200
    assert json.loads(text)["text"] is None


def test_it_listens_on_this_machine_alone(server):
    assert server.server_address[0] == "127.0.0.1"


@pytest.mark.parametrize(
    "name", ["../x.step", "a/b.step", "..\\x.step", ".hidden.step", "a\0.step", "x.step.", "é.step"]
)
def test_uploads_cannot_leave_the_folder(server, tmp_path, name):
    before = sorted(tmp_path.parent.rglob("*"))
    answer, text = ask(server, f"api/file?name={quote(name)}", "POST", b"data")
    assert answer.status == 200
    assert "not a file name that Faying accepts" in json.loads(text)["fault"]
    assert sorted(tmp_path.parent.rglob("*")) == before


@pytest.mark.parametrize(
    "path", ["../study.toml", "%2e%2e/study.toml", "..%2fstudy.toml", "/etc/passwd", "%2fetc%2fpasswd"]
)
def test_results_cannot_leave_their_folder(server, tmp_path, path):
    (tmp_path / "study.toml").write_text("secret")
    (tmp_path / "results").mkdir()
    answer, text = ask(server, f"results/{path}")
    assert answer.status == 404
    assert "secret" not in text


def test_a_link_that_leads_out_of_the_folder_is_not_followed(server, tmp_path):
    (tmp_path / "results").mkdir()
    outside = tmp_path.parent / "outside.csv"
    outside.write_text("secret")
    (tmp_path / "results" / "modes.csv").symlink_to(outside)
    answer, text = ask(server, "results/modes.csv")
    assert answer.status == 404
    assert "secret" not in text


def test_an_upload_of_10_gb_is_refused_before_it_is_sent(server, tmp_path):
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=10) as line:
        head = f"POST /{server.token}/api/file?name=scan.x3p HTTP/1.1\r\nHost: 127.0.0.1:{server.server_port}\r\n"
        line.sendall(f"{head}Content-Length: {10 << 30}\r\n\r\n".encode())
        answer = line.makefile("rb").read().decode()  # it ends without a byte of the body
    assert answer.startswith("HTTP/1.1 413")
    assert f"{LARGEST >> 30} GB at most" in answer
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("length", ["-1", "1e3", "ten", "٣"])
def test_a_length_that_is_no_number_is_refused(server, length):
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=10) as line:
        head = f"POST /{server.token}/api/file?name=scan.x3p HTTP/1.1\r\nHost: 127.0.0.1:{server.server_port}\r\n"
        line.sendall(f"{head}Content-Length: {length}\r\n\r\n".encode())
        assert line.makefile("rb").read().startswith(b"HTTP/1.1 400")


def test_a_length_of_5_000_digits_is_refused(server):
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=10) as line:
        head = f"POST /{server.token}/api/file?name=scan.x3p HTTP/1.1\r\nHost: 127.0.0.1:{server.server_port}\r\n"
        line.sendall(f"{head}Content-Length: {'9' * 5000}\r\n\r\n".encode())
        assert line.makefile("rb").read().startswith(b"HTTP/1.1 413")


def test_json_nested_without_end_is_refused(server):
    body = "[" * 50_000 + "]" * 50_000
    assert "is not JSON" in json.loads(ask(server, "api/study", "PUT", body)[1])["fault"]


def test_a_fault_of_ours_is_an_answer(server, monkeypatch):
    def broken(session, request):
        raise TypeError("a number is None")

    monkeypatch.setitem(routes.ROUTES, ("GET", "check"), broken)
    answer, text = ask(server, "api/check")
    assert answer.status == 200
    assert json.loads(text)["fault"].startswith("a fault inside Faying (TypeError: a number is None) in GET check")
    monkeypatch.setitem(routes.ROUTES, ("GET", "check"), lambda session, request: {"k": float("nan")})
    assert "ValueError" in json.loads(ask(server, "api/check")[1])["fault"]


def test_an_upload_that_breaks_off_leaves_nothing(server, tmp_path):
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=10) as line:
        head = f"POST /{server.token}/api/file?name=scan.x3p HTTP/1.1\r\nHost: 127.0.0.1:{server.server_port}\r\n"
        line.sendall(f"{head}Content-Length: 1000\r\n\r\nhalf".encode())
        line.shutdown(socket.SHUT_WR)
        assert b"ended 996 bytes early" in line.makefile("rb").read()
    assert list(tmp_path.iterdir()) == []


def test_an_upload_lies_in_the_folder_afterwards(server, tmp_path):
    content = bytes(range(256)) * 5000
    answer, _ = ask(server, "api/file?name=a%20scan%20(2).x3p", "POST", content)
    assert answer.status == 200
    assert (tmp_path / "a scan (2).x3p").read_bytes() == content
    files = json.loads(ask(server, "api/project")[1])["files"]
    assert files == [{"name": "a scan (2).x3p", "size": len(content), "kinds": ["scan"]}]


def test_a_file_of_no_known_kind_is_refused(server):
    answer, text = ask(server, "api/file?name=run.exe", "POST", b"MZ")
    assert answer.status == 200
    assert ".x3p" in json.loads(text)["fault"]


def test_files_of_the_folder_are_listed_by_what_they_hold(server, tmp_path):
    """Decks and scans of one suffix, a file that a deck includes, and a page that quotes a deck."""
    files = {
        "ds.dat": (b"! by hand\n/PREP7\nET,1,185\n", ["mesh"]),
        "deck.dat": (b"$\nSOL 103\nCEND\n", ["mesh"]),
        "scan.dat": (b"0 0 1.5\n0 1 1.25\n", ["scan"]),
        "all.msh": (b"*NODE, NSET=NALL\n1,0,0,0\n", ["mesh"]),
        "hit.txt": (b"    -1\n    58\n", ["test"]),
        "decay.csv": (b"time [s],acceleration [m/s^2]\n0,1\n", ["test"]),
    }
    for name, (content, _) in files.items():
        assert "fault" not in json.loads(ask(server, f"api/file?name={name}", "POST", content)[1])
    (tmp_path / "page.html").write_text("<p>\n*NODE\n1,0,0,0\nGRID,1\n")
    listed = json.loads(ask(server, "api/project")[1])["files"]
    assert {one["name"]: one["kinds"] for one in listed} == {name: kinds for name, (_, kinds) in files.items()}
    _, text = ask(server, "api/file?name=part.stp", "POST", b" " * 72 + b"S      1\n")
    assert "part.stp is an IGES file, which is not read here" in json.loads(text)["fault"]
    assert not (tmp_path / "part.stp").exists()


def test_names_cannot_be_taken_for_options(server, tmp_path):
    (tmp_path / "--help.x3p").write_text("")
    answer, text = ask(server, "api/scan?name=--help.x3p")
    assert answer.status == 200
    assert "no file" in json.loads(text)["fault"]


@pytest.mark.parametrize(
    ("method", "path", "status"), [("GET", "api/nothing", 404), ("PUT", "", 405), ("GET", "x.js", 404)]
)
def test_what_there_is_not(server, method, path, status):
    assert ask(server, path, method)[0].status == status


def test_only_listed_commands_run(server, tmp_path):
    (tmp_path / "study.toml").write_text("")
    answer, text = ask(server, "api/job?command=init", "POST")
    assert answer.status == 200
    assert "run, predict" in json.loads(text)["fault"]


def test_the_study_is_saved_as_it_was_typed(server, tmp_path):
    text = 'title = "<script>alert(1)</script> µm"\n'
    assert ask(server, "api/study", "PUT", json.dumps({"text": text, "before": ""}))[1] == '{"saved": true}'
    assert (tmp_path / "study.toml").read_text(encoding="utf-8") == text
    assert json.loads(ask(server, "api/project")[1])["text"] == text
    assert ask(server, "api/study", "PUT", json.dumps({"text": "x" * (1 << 20) + "y", "before": text}))[1].startswith(
        '{"fault"'
    )
    assert "not a table of JSON" in ask(server, "api/study", "PUT", "[1]")[1]
    assert (tmp_path / "study.toml").read_text(encoding="utf-8") == text


def test_what_another_editor_wrote_is_not_overwritten(server, tmp_path):
    (tmp_path / "study.toml").write_text("theirs\n")
    text = ask(server, "api/study", "PUT", json.dumps({"text": "mine", "before": "ours\n"}))[1]
    assert "changed outside of this page" in json.loads(text)["fault"]
    assert (tmp_path / "study.toml").read_text() == "theirs\n"
    assert "saved" in ask(server, "api/study", "PUT", json.dumps({"text": "mine", "before": "theirs\n"}))[1]
    assert (tmp_path / "study.toml").read_text() == "mine"


def test_a_folder_with_several_studies_asks_which(tmp_path):
    for name in ("a.toml", "b.toml"):
        (tmp_path / name).write_text("[geometry]\n")
    (tmp_path / "pyproject.toml").write_text("[project]\n")
    with pytest.raises(InputError, match=r"several studies: a\.toml, b\.toml"):
        Project.at(tmp_path)
    assert Project.at(tmp_path / "b.toml").study_name == "b.toml"
    (tmp_path / "b.toml").unlink()
    assert Project.at(tmp_path).study_name == "a.toml"


@pytest.mark.parametrize("name", ["scan.x3p", "a b.step", "x_1-2(3)+4.csv"])
def test_ordinary_names_are_taken(name):
    assert checked_name(name) == name


def test_a_port_that_is_taken_says_so(server, tmp_path):
    with pytest.raises(InputError, match="leave out --port"):
        Server(Project.at(tmp_path), server.server_port)


@pytest.mark.parametrize("name", ["study.toml", "scan.csv"])
def test_no_file_is_replaced_by_an_upload_unasked(server, tmp_path, name):
    (tmp_path / name).write_text("a = 1")
    _, found = ask(server, f"api/file?name={name}", "POST", b"b = 2")
    assert "is there already" in json.loads(found)["fault"]
    assert (tmp_path / name).read_text() == "a = 1"
    ask(server, f"api/file?name={name}&replace=yes", "POST", b"b = 2")
    assert (tmp_path / name).read_text() == "b = 2"


def test_a_file_is_not_replaced_while_a_job_reads_it(server, tmp_path, monkeypatch):
    (tmp_path / "scan.csv").write_text("a = 1")
    monkeypatch.setattr(server.session, "job", SimpleNamespace(running=True, command="faying run", cancel=lambda: None))
    _, found = ask(server, "api/file?name=scan.csv&replace=yes", "POST", b"b = 2")
    assert "faying run still runs" in json.loads(found)["fault"]
    assert (tmp_path / "scan.csv").read_text() == "a = 1"


def test_half_an_address_is_refused(server, capfd):
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=10) as line:
        line.sendall(f"GET http://[::1/x HTTP/1.1\r\nHost: 127.0.0.1:{server.server_port}\r\n\r\n".encode())
        assert line.recv(100).startswith(b"HTTP/1.1 400")
    assert "Traceback" not in capfd.readouterr().err


def test_two_hundred_connections_at_once(server):
    with ExitStack() as stack:
        lines = [
            stack.enter_context(socket.create_connection(("127.0.0.1", server.server_port), timeout=10))
            for _ in range(200)
        ]
        for line in lines:
            line.sendall(f"GET /{server.token}/ HTTP/1.1\r\nHost: 127.0.0.1:{server.server_port}\r\n\r\n".encode())
        assert all(line.recv(15) == b"HTTP/1.1 200 OK" for line in lines)


@pytest.mark.parametrize(
    ("text", "words", "line"),
    [
        ("a = ", "the text is not TOML", 1),
        ("[modes]\ncount = 3\ncuont = 4\n", "cuont", 3),
        ("title = 'x'\n[[bolt]]\npreload = 5\n", "preload", 3),
    ],
)
def test_faults_of_a_text_that_is_typed(server, text, words, line):
    _, found = ask(server, "api/read", "POST", json.dumps({"text": text}).encode())
    faults = [one for one in json.loads(found)["findings"] if words in one["text"]]
    assert faults
    assert faults[0]["line"] == line
