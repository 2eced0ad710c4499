"""The study that `faying new` writes of an assembly, coarse and cheap to run."""

import re

from click.testing import CliRunner

from faying.cli.main import cli


def proposed(path, size, *options):
    """The study that `faying new` writes with options, with elements of a size, the JK law and flat faces."""
    out = path.with_suffix(".toml")
    done = CliRunner().invoke(
        cli, ["new", str(path), "--yes", "--force", "--out", str(out), *options], standalone_mode=False
    )
    assert done.exception is None, done.output
    text = re.sub(r'^size = "[^"]*"', f'size = "{size}"', out.read_text(), flags=re.M)
    text = text.replace('model = "auto"', 'model = "jk"').replace("count = 10 ", "levels = []\ncount = 4 ")
    out.write_text(re.sub(r"(\[\[joint\]\]\n(?:.+\n)+)", r"\1[joint.form]\nflat = true\n\n", text))
    return out
