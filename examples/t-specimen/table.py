"""Print the comparison with the test for four joints: the default law and JK, each with the hollow and with flat faces.

Run: uv run --extra pardiso python examples/t-specimen/table.py (some minutes).
"""

from dataclasses import replace
from pathlib import Path

import faying
from faying.joint.form import Form
from faying.output import table
from faying.study import Study
from faying.study.keys.beside import BesideChoice

STUDY = Study.read(Path(__file__).parent / "study.toml")
FLAT = BesideChoice(name="default, flat", form=Form())
(JK,) = STUDY.beside

if __name__ == "__main__":
    besides = (FLAT, replace(JK, name="JK, flat"), replace(JK, name="JK, hollow", form=None))
    print(table.text(table.comparison(faying.run(replace(STUDY, beside=besides)))))
