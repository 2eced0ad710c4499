"""Read an archive with mapdl-archive and print elements, keys and real constants as JSON; in its own environment."""

import json
import sys

from mapdl_archive import Archive

archive = Archive(sys.argv[1], parse_vtk=False)
sets = {int(n): [float(v) for v in row] for n, row in zip(archive.rlblock_num, archive.rlblock)}  # noqa: B905
elements = [[int(e[1]), int(e[2]), int(e[-2]), int(e[-1])] for e in archive.elem]
keys = {int(k): {int(i): int(v) for i, v in rows} for k, rows in archive.key_option.items()}
print(json.dumps({"sets": sets, "elements": elements, "keys": keys, "types": archive.ekey.tolist()}))
