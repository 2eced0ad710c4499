import json
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import click
import pytest

import faying
from faying.cli import main
from faying.cli.main import COMMANDS, cli
from faying.cli.options import NamedPath
from tests.helpers.studies import write

EXAMPLES = Path(__file__).parents[2] / "examples"


def call(*args):
    return subprocess.run([sys.executable, "-m", "faying", *args], capture_output=True, text=True, check=False)


def test_help_lists_every_command_and_imports_nothing_heavy():
    out = call("--help")
    assert out.returncode == 0
    for command in ("init", "law", "run", "surface"):
        assert f"\n  {command} " in out.stdout
    code = (
        "import sys; from faying.cli import main\ntry: main(['--help'])\nexcept SystemExit: pass\n"
        "print([m for m in ('numpy', 'scipy', 'matplotlib', 'pint', 'netgen', 'skfem') if m in sys.modules])"
    )
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert loaded.stdout.strip().endswith("[]")


@pytest.mark.parametrize("command", ["init", "law", "run", "surface"])
def test_every_command_has_help(command, capsys):
    with pytest.raises(SystemExit) as stop:
        main([command, "--help"])
    assert stop.value.code == 0
    assert "--json" in capsys.readouterr().out


def test_exit_codes(tmp_path, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["run", str(tmp_path / "none.toml")])
    assert stop.value.code == 1
    assert "faying: no file" in capsys.readouterr().err
    with pytest.raises(SystemExit) as stop:
        main(["run"])
    assert stop.value.code == 2
    with pytest.raises(SystemExit) as stop:
        main(["dance"])
    assert stop.value.code == 2


def test_init_and_run(tmp_path, capsys):
    path = tmp_path / "mine.toml"
    with pytest.raises(SystemExit) as stop:
        main(["init", str(path)])
    assert stop.value.code == 0
    capsys.readouterr()
    path.write_text(path.read_text().replace('size = "8 mm"', 'size = "20 mm"').replace('= "4 mm"\n', '= "10 mm"\n', 1))
    with pytest.raises(SystemExit) as stop:
        main(["run", str(path), "--json"])
    assert stop.value.code == 0
    captured = capsys.readouterr()
    data = json.loads(captured.out)
    assert data["title"] == "Two blocks and a bolt"
    made = {p.name for p in (tmp_path / "results" / "mine").iterdir()}
    figures = ("intervals", "narrowing", "frequencies", "damping", "pressure", "slip", "law", "mac")
    assert made == {"result.nc", "modes.csv", "report.html", "modes.png", *(f"{name}.svg" for name in figures)}
    report = (tmp_path / "results" / "mine" / "report.html").read_text()
    assert "outside its validity range" in report  # the flag travels with the numbers
    assert not re.search(r'(src|href)="(?!data:|#)', report)  # nothing is fetched: one self-contained file
    assert "\x1b[" not in captured.out  # no colour when not a terminal


def test_init_keeps_what_is_not_its_own(tmp_path, capsys):
    """Another study, or the same again, goes beside the same blocks; what somebody changed stays unless forced."""
    study, step = tmp_path / "mine.toml", tmp_path / "two-blocks.step"

    def init(*words):
        with pytest.raises(SystemExit) as stop:
            main(["init", *map(str, words)])
        return stop.value.code, capsys.readouterr().err

    assert init(study)[0] == 0
    first, blocks = study.read_text(), step.read_bytes()
    assert init(study)[0] == init(tmp_path / "other.toml")[0] == 0
    assert step.read_bytes() == blocks
    study.write_text(first + "# mine\n")
    code, said = init(study)
    assert code == 1
    assert "mine.toml exists already, with other content; name another file, or replace it with --force" in said
    step.write_bytes(blocks.replace(b"upper.seat", b"upper.bolt"))
    code, said = init(tmp_path / "third.toml")
    assert code == 1
    assert "two-blocks.step exists already" in said
    assert not (tmp_path / "third.toml").exists()
    assert init(study, "--force")[0] == 0
    assert study.read_text() == first
    assert b"upper.bolt" not in step.read_bytes()


def test_a_run_that_fails_leaves_no_folder(tmp_path, capsys):
    path = tmp_path / "study.toml"
    write(path)
    path.write_text(path.read_text().replace('"upper.seat"', '"upper.set"'))
    kept = tmp_path / "kept"
    kept.mkdir()
    (kept / "mine.txt").write_text("mine")
    for folder in (tmp_path / "new" / "deep", kept, kept / "below"):
        with pytest.raises(SystemExit) as stop:
            main(["run", str(path), "--out", str(folder)])
        assert stop.value.code == 1
        assert "'upper.set', which does not exist" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()
    assert [p.name for p in kept.iterdir()] == ["mine.txt"]
    with pytest.raises(SystemExit) as stop:
        main(["run", str(path), "--out", str(kept / "mine.txt" / "below")])
    assert stop.value.code == 1
    assert "cannot make the folder" in capsys.readouterr().err


def test_version(capsys):
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(SystemExit):
        main(["--version"])
    assert faying.__version__ in capsys.readouterr().out
    assert signal.getsignal(signal.SIGTERM) is before  # whoever calls a command from Python keeps their own


def test_completion_of_the_shell_knows_the_commands():
    """The script of click, and what it asks: the commands that begin so, and their options."""
    import os

    def asked(**given):
        words = [sys.executable, "-c", "from faying.cli import main; main()"]
        return subprocess.run(words, capture_output=True, text=True, check=False, env=os.environ | given).stdout

    assert "complete -o nosort -F _faying_completion faying" in asked(_FAYING_COMPLETE="bash_source")
    there = asked(_FAYING_COMPLETE="bash_complete", COMP_WORDS="faying ", COMP_CWORD="1").split()
    assert {"plain,new", "plain,faces", "plain,check", "plain,schema", "plain,run"} <= set(there)
    options = asked(_FAYING_COMPLETE="bash_complete", COMP_WORDS="faying new --", COMP_CWORD="2").split()
    assert {"plain,--scan", "plain,--yes", "plain,--force"} <= set(options)


def test_an_end_of_file_in_a_command_is_no_interruption(monkeypatch):
    """click takes EOFError for the user's wish to stop; it is a fault of ours, which must show."""
    from faying.cli.scan import models

    def ends(**_):
        raise EOFError("marshal data too short")

    monkeypatch.setattr(models.command, "callback", ends)
    with pytest.raises(EOFError, match="too short"):
        main(["models"])


def test_a_name_beyond_ascii_runs_in_the_plain_locale(tmp_path):
    """LANG=C, without Python's own way round: what is printed and written keeps the name."""
    path = tmp_path / "study" / "study.toml"
    path.parent.mkdir()
    write(path)
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace('title = "', 'title = "Träger, ', 1), encoding="utf-8")
    plain = {**os.environ, "LC_ALL": "C", "LANG": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
    done = subprocess.run(
        [sys.executable, "-m", "faying", "run", str(path)], env=plain, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "Träger" in (tmp_path / "study" / "results" / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(("name", "said"), [("", "the name is empty"), (300 * "x", "more than 240 bytes")])
def test_no_command_takes_a_path_that_no_file_can_have(command, name, said):
    context = click.Context(cli, info_name="faying")
    every = cli.get_command(context, command).params
    assert not [one.name for one in every if isinstance(one.type, click.Path) and not isinstance(one.type, NamedPath)]
    for one in every:
        if isinstance(one.type, NamedPath):
            with pytest.raises(click.BadParameter, match=said):
                one.type.convert(name, one, context)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--z-unit", "um", "--D", "2.39"], "--z-unit: with --scan FILE alone"),
        (["--method", "structure", "--D", "2.39"], "--method: with --scan FILE alone"),
        (
            ["--scan", str(EXAMPLES / "t-specimen" / "milled.x3p"), "--G", "1e-11 m"],
            "G beside --scan: D, G and scan_area",
        ),
        (["--D", "2.39", "--to", "abaqus", "--unit", "mm", "--json"], "--json: --to prints one law on first loading"),
    ],
)
def test_options_of_law_that_do_not_apply_are_faults(options, said, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["law", "--material", "45 steel", *options])
    assert stop.value.code == 1
    assert said in capsys.readouterr().err


@pytest.mark.skipif(os.name == "nt", reason="a shell of Unix closes the stream")
@pytest.mark.parametrize("closed", [pytest.param("2>&-", marks=pytest.mark.slow), ">&- 2>&- <&-"])
def test_a_run_whose_streams_are_closed_ends_as_any_other(closed, tmp_path):
    shutil.copytree(EXAMPLES / "two-blocks", tmp_path / "blocks")
    words = f"{sys.executable} -m faying run blocks/study.toml --no-files {closed}"
    done = subprocess.run(words, shell=True, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0
    assert ("Hz" in done.stdout) == (">&- 2" not in closed)
