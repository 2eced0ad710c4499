"""What the page asks for: a table of (method, path) -> function of the session and the query."""

import json
import tempfile
import threading
from base64 import b64encode
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from io import BufferedIOBase
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faying import __version__
from faying.app.commands import Job, answer
from faying.app.project import Project, checked_name
from faying.errors import FayingError, InputError
from faying.files import make_folder
from faying.setup.edit import key_of, line_of, line_of_fault, lines_of
from faying.study import Study
from faying.study.declaration.reader import StudyFaults
from faying.text import toml

if TYPE_CHECKING:
    from faying.app.runs import Runs
    from faying.app.scans import OpenScan


OF_SCAN = ("xy-unit", "z-unit", "size", "channel")  # of a request: how a scan is read, as options of commands
# what may run, with the pictures that it draws for the page
JOBS: dict[str, dict[str, str]] = {
    "run": {},
    "predict": {"--plot": "prediction.svg", "--tornado": "tornado.svg"},
    "identify": {"--plot": "identification.svg"},
    "backbone": {"--plot": "backbone.svg"},
}


@dataclass(frozen=True, kw_only=True)
class Request:
    """The query of a request, and its body, which is read by whoever wants it."""

    query: Mapping[str, str]
    body: BufferedIOBase
    size: int

    @property
    def of_scan(self) -> list[str]:
        """Options of how a scan is read."""
        return [f"--{key}={self.query[key]}" for key in OF_SCAN if key in self.query]

    def given(self, name: str) -> str:
        """A value of the query. Raises InputError where it is missing."""
        if name not in self.query:
            raise InputError(f"the request lacks {name}")
        return self.query[name]

    def data(self) -> dict[str, Any]:
        """The body as JSON. Raises InputError where it is none."""
        try:
            found = json.loads(self.body.read(self.size))
        except (ValueError, RecursionError):
            raise InputError("the request is not JSON") from None
        if not isinstance(found, dict):
            raise InputError("the request is not a table of JSON")
        return found


class Session:
    """The project that is open, and the job that runs on it."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self.job: Job | None = None
        self._runs: Runs | None = None
        self._open: tuple[object, OpenScan] | None = None
        self._lock, self._reading = threading.Lock(), threading.Lock()

    @property
    def runs(self) -> "Runs":
        """The last results."""
        from faying.app.runs import Runs

        if self._runs is None or self._runs.project != self.project:
            self._runs = Runs(self.project)
        return self._runs

    def close(self) -> None:
        """Stop the job that runs."""
        if self.job is not None:
            self.job.cancel()

    def look(self, request: Request) -> dict[str, Any]:
        """All that the page needs to draw itself."""
        job = None if self.job is None else self.job.state()
        if (self.project.results / "result.nc").is_file():
            self.runs.keep()
        return self.project.listed() | {"job": job, "version": __version__}

    def _check_idle(self) -> None:
        """Raise InputError while a job runs, which reads the files of the folder."""
        if self.job is not None and self.job.running:
            raise InputError(f"{self.job.command} still runs; cancel it or wait")

    def upload(self, request: Request) -> dict[str, Any]:
        """Take a file into the folder."""
        name, replace = request.given("name"), request.query.get("replace") == "yes"
        if replace:
            self._check_idle()
        return {"name": self.project.receive(name, request.body, request.size, replace=replace).name}

    def save(self, request: Request) -> dict[str, Any]:
        """Save the study's text."""
        data = request.data()
        text, before = data.get("text"), data.get("before")
        if not isinstance(text, str) or not isinstance(before, str):
            raise InputError("the request lacks text, or the text that it replaces")
        with self._lock:
            self.project.save_text(text, before)
        return {"saved": True}

    def read(self, request: Request) -> dict[str, Any]:
        """Faults of a text that is being typed, and its form."""
        text = request.data().get("text")
        if not isinstance(text, str):
            raise InputError("the request lacks text")
        return {"findings": faults_of(text, self.project.folder), "form": self._form(text)}

    def edit(self, request: Request) -> dict[str, Any]:
        """Change one key of a text as the form says, add a table, or take one out; nothing is saved."""
        from faying.app.form import added, changed, removed

        data = request.data()
        text, path, value, action = (data.get(key) for key in ("text", "path", "value", "action"))
        if not isinstance(text, str) or not isinstance(path, list) or not path:
            raise InputError("the request lacks text, or the path of a key")
        if not all(isinstance(one, str | int) and not isinstance(one, bool) for one in path):
            raise InputError("the path of a key has names and places in lists only")
        place = tuple(path)
        if action in ("add", "remove"):
            return {"text": (added if action == "add" else removed)(text, place)}
        if not isinstance(value, str):
            raise InputError("the request lacks what was written in the field")
        return {"text": changed(text, place, value)}

    def schema(self, request: Request) -> str:
        """The JSON schema of a study, as `faying schema` gives it."""
        from faying.study.schema import schema_text

        return schema_text()

    def check(self, request: Request) -> dict[str, Any]:
        """Check the study as `faying check` does."""
        return self._answer("check", self.project.study_name)

    def example(self, request: Request) -> dict[str, Any]:
        """Write a small study that runs, as `faying init` does."""
        return self._answer("init", self.project.study_name)

    def propose(self, request: Request) -> dict[str, Any]:
        """Write a study for a STEP file, as `faying new` does; an existing study is replaced where that is wanted."""
        arguments = ["new", self._name(request, "geometry"), "--yes", "--out", self.project.study_name]
        if "scan" in request.query:
            arguments += ["--scan", self._name(request, "scan")]
        return self._answer(*arguments, *(["--force"] if request.query.get("replace") == "yes" else []))

    def scan(self, request: Request) -> dict[str, Any]:
        """Roughness, D and G of a scan with its picture, as `faying surface` gives them."""
        return self._pictured("surface", self._name(request, "name"), *request.of_scan)

    def laws(self, request: Request) -> dict[str, Any]:
        """The laws on a scan beside each other, as `faying law --all-models` gives them."""
        material = request.query.get("material", "45 steel")
        scan = f"--scan={self._name(request, 'name')}", *request.of_scan
        return {"facts": self._answer("law", *scan, "--all-models", f"--material={material}", "--against=same")}

    def map(self, request: Request) -> dict[str, Any]:
        """A window of a scan as a map."""
        from faying.app.scans import window_of

        return self._scan(request).map(window_of(request.given("window")))

    def line(self, request: Request) -> dict[str, Any]:
        """Heights along a line of a scan."""
        from faying.app.scans import window_of

        try:
            at = float(request.given("at"))
        except ValueError:
            raise InputError("the request lacks the place of the line, a share from 0 to 1") from None
        return self._scan(request).line(request.given("along"), at, window_of(request.given("window")))

    def faces(self, request: Request) -> dict[str, Any]:
        """The faces of a STEP file or mesh, as `faying faces` lists them."""
        return self._answer("faces", self._name(request, "name"))

    def begin(self, request: Request) -> dict[str, Any]:
        """Start a job on the study, one at a time."""
        what = request.given("command")
        if what not in JOBS:
            raise InputError(f"{what!r} is none of {', '.join(JOBS)}")
        with self._lock:
            self._check_idle()
            if self.project.text() is None:
                raise InputError("there is no study yet")
            if JOBS[what]:
                make_folder(self.project.folder / self.project.results_name, "free its name in the folder")
            pictures = [f"{option}={self.project.results_name}/{file}" for option, file in JOBS[what].items()]
            self.job = Job([what, self.project.study_name, *pictures], self.project.folder)
        return self.job.state()

    def progress(self, request: Request) -> dict[str, Any]:
        """The job's state; nothing where there was none."""
        return {} if self.job is None else self.job.state()

    def cancel(self, request: Request) -> dict[str, Any]:
        """Stop the job."""
        if self.job is not None:
            self.job.cancel()
        return self.progress(request)

    def results(self, request: Request) -> dict[str, Any]:
        """The last results, the newest first."""
        return {"runs": self.runs.listed()}

    def compare(self, request: Request) -> dict[str, Any]:
        """Two of the last results compared."""
        return self.runs.compared(request.given("first"), request.given("second"), request.query.get("preload", ""))

    def scene(self, request: Request) -> str:
        """The scene of a file of the folder, or of the study, as `faying view` shows it."""
        from faying.output.scene import of_file, to_text

        what = request.given("of")
        path = self.project.study if what == "study" else self.project.file(what)
        return to_text(of_file(path, request.query.get("unit")))

    def _name(self, request: Request, key: str) -> str:
        """The name of a file of the folder, which cannot be taken for an option."""
        name = checked_name(request.given(key))
        if name.startswith("-") or not self.project.file(name).is_file():
            raise InputError(f"no file {name!r} in the folder")
        return name

    def spectrum(self, request: Request) -> dict[str, Any]:
        """The spectrum of a scan with the fit over a band."""
        from faying.app.scans import band_of

        return self._scan(request).spectrum(band_of(request.query.get("band")))

    def _scan(self, request: Request) -> "OpenScan":
        """The scan that a request names, read once."""
        from faying.app.scans import OpenScan

        path = self.project.file(self._name(request, "name"))
        units = tuple(request.query.get(key) for key in OF_SCAN)
        mark = (path.name, path.stat().st_mtime_ns, units)
        with self._reading:
            if self._open is None or self._open[0] != mark:
                self._open = (mark, OpenScan.read(path, *units))
            return self._open[1]

    def _form(self, text: str) -> list[dict[str, Any]] | None:
        """The form of a text; None where it is not TOML, which is a fault of its own."""
        from faying.app.form import form_of

        try:
            return form_of(text, self.project.by_kind())
        except InputError:
            return None

    def _answer(self, *arguments: str) -> dict[str, Any]:
        return answer(arguments, self.project.folder)

    def _pictured(self, *arguments: str) -> dict[str, Any]:
        """What a command says, and what it draws."""
        with tempfile.TemporaryDirectory() as folder:
            picture = Path(folder) / "picture.png"
            found = self._answer(*arguments, f"--plot={picture}")
            return {"facts": found, "picture": b64encode(picture.read_bytes()).decode()}


ROUTES: dict[tuple[str, str], Callable[[Session, Request], dict[str, Any] | str]] = {
    ("GET", "project"): Session.look,
    ("POST", "file"): Session.upload,
    ("PUT", "study"): Session.save,
    ("POST", "read"): Session.read,
    ("POST", "edit"): Session.edit,
    ("GET", "schema"): Session.schema,
    ("GET", "check"): Session.check,
    ("POST", "example"): Session.example,
    ("POST", "new"): Session.propose,
    ("GET", "scan"): Session.scan,
    ("GET", "laws"): Session.laws,
    ("GET", "map"): Session.map,
    ("GET", "line"): Session.line,
    ("GET", "spectrum"): Session.spectrum,
    ("GET", "faces"): Session.faces,
    ("GET", "scene"): Session.scene,
    ("GET", "runs"): Session.results,
    ("GET", "compare"): Session.compare,
    ("POST", "job"): Session.begin,
    ("GET", "job"): Session.progress,
    ("DELETE", "job"): Session.cancel,
}


def answered(session: Session, method: str, path: str, request: Request) -> bytes | None:
    """The answer to a request as JSON, {"fault": ...} where it cannot be; None where there is no such route."""
    route = ROUTES.get((method, path))
    if route is None:
        return None
    try:
        found = route(session, request)
        return (found if isinstance(found, str) else json.dumps(found, allow_nan=False)).encode()
    except FayingError as fault:  # an answer like others: what the user should read
        return json.dumps({"fault": str(fault)}).encode()
    except ConnectionError:  # the page was closed
        raise
    except Exception as fault:  # a fault of ours is an answer, too: the page goes on
        words = f"a fault inside Faying ({type(fault).__name__}: {fault}) in {method} {path}; please report it"
        return json.dumps({"fault": words}).encode()


def faults_of(text: str, folder: Path) -> list[dict[str, Any]]:
    """Return the faults of a text, each with its line where that is known; files are not opened, nothing is meshed.

    Args:
        text: of the study.
        folder: in which the files lie that it names.
    """
    try:
        data = toml(text)
    except ValueError as fault:
        return [_fault(f"the text is not TOML: {fault}", line_of_fault(fault, text))]
    lines = lines_of(text)
    try:
        Study.from_dict(data, folder=folder, text=text)
    except StudyFaults as faults:
        return [_fault(line, line_of(key_of(line, lines), lines)) for line in faults.lines]
    except FayingError as fault:
        return [_fault(str(fault), None)]
    return []


def _fault(text: str, line: int | None) -> dict[str, Any]:
    return {"level": "fault", "text": text, "line": line}
