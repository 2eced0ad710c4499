"""
Modes that move
===============

Two blocks pressed together, and the viewer of ``report.html`` with their modes.
"""

from pathlib import Path

import faying

study = next(
    path / "examples" / "two-blocks" / "study.toml"
    for path in Path.cwd().parents
    if (path / "examples" / "two-blocks").is_dir()
)
result = faying.run(study)

# %%
# A page of one file that asks for nothing: drag to turn, choose a mode and a preload, colour by motion or pressure.
# ``faying view`` writes the same page.

faying.view(result)

# %%
# The first mode bends across the joint: its frequency rises with the preload, which stiffens the joint.

print(result.frequencies[:, 0])
assert result.frequencies[1, 0] > 1.02 * result.frequencies[0, 0]
