"""The study of `faying init` under the JK law of given D and G: cheap, with a loss, and with keys to vary."""

from pathlib import Path

from faying.study import template

START, END = template.TEXT.index("# The rough surface"), template.TEXT.index('[[joint]]\nname = "joint"')
TEXT = (
    template.TEXT[:START]
    + """[surface]
D = 2.39
G = "1.53e-10 m"
scan_area = "16 mm^2"

[law]
model = "jk"
closure = "consistent"
loss = "held"
cutoff = 0.01
substrate = 1.0
counterbody = "part"

"""
    + template.TEXT[END:]
)


def write(study: Path, *, force: bool = False) -> list[Path]:
    """Write that study, with the geometry that `faying init` gives it."""
    made = template.write(study, force=force)
    study.write_text(TEXT.format(name=study.name, step="two-blocks.step"), encoding="utf-8")
    return made
