"""The study of `faying init` under JK of given D and G, coarse, at 2 and 6 kN: cheap, with a loss, and keys to vary."""

from pathlib import Path

from faying.setup import template

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
    + template.TEXT[END:].replace('["8 kN", "15 kN"] ', '["2 kN", "6 kN"]  ')
)
TEXT = TEXT.replace('size = "8 mm" ', 'size = "16 mm"').replace('"upper.joint" = "4 mm"', '"upper.joint" = "8 mm"')


def write(study: Path, *, force: bool = False, flat: bool = True) -> list[Path]:
    """Write that study, with the geometry that `faying init` gives it.

    Damping at levels of acceleration is left out. flat: its faces are flat, and intervals are left out; else nothing is
    said of them, and a run has intervals and draws of waves, which double its time.
    """
    made = template.write(study, force=force)
    text = TEXT.format(name=study.name, step="two-blocks.step")
    text = text.replace("[modes]\n", "[modes]\nlevels = []\n")
    if flat:
        text = text.replace("levels = []\n", "levels = []\nintervals = false\n")
        text = text.replace("\n[[bolt]]", "\n[joint.form]\nflat = true\n\n[[bolt]]", 1)
    study.write_text(text, encoding="utf-8")
    return made


def write_coarse(path: Path) -> None:
    """Write that study with elements of 20 mm and three modes."""
    write(path)
    text = path.read_text()
    at = text.index("[geometry]")
    size = next(line for line in text[at:].splitlines() if line.startswith("size"))
    rough = "\n".join(line for line in text.splitlines() if not line.startswith("face_size"))
    path.write_text(rough.replace(size, 'size = "20 mm"').replace("count = 6", "count = 3"))
