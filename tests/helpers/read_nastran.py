"""Read bulk data with pyNastran and print the joint's matrices as JSON; runs in an environment of its own."""

import json
import sys

import numpy as np
from pyNastran.bdf.bdf import BDF

model = BDF(log=None, debug=None)
model.read_bdf(sys.argv[1], xref=True, punch=False)
out = {"stiffness": [], "loss": []}


def add(kind, n1, c1, n2, c2, value):
    if value:
        out[kind].append([int(n1), int(c1), int(n2), int(c2), float(value)])


for element in model.elements.values():
    if element.type == "CELAS2":
        for kind, k in (("stiffness", element.k), ("loss", element.k * element.ge)):
            a, b = (element.nodes[0], element.c1), (element.nodes[1], element.c2)
            for one, two, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                add(kind, *one, *two, sign * k)
    elif element.type == "CBUSH":
        frame = element.cid_ref.beta()
        k = np.array([v or 0.0 for v in element.pid_ref.Ki[:3]])
        ge = np.array([v or 0.0 for v in (list(element.pid_ref.GEi) + [0.0] * 6)[:3]])
        a, b = element.nodes
        for kind, values in (("stiffness", k), ("loss", k * ge)):
            block = frame.T @ np.diag(values) @ frame
            for i in range(3):
                for j in range(3):
                    for one, two, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                        add(kind, one, i + 1, two, j + 1, sign * block[i, j])
for name, kind in (("KJOINT", "stiffness"), ("K4JOINT", "loss")):
    if name in model.dmig:
        matrix, rows, columns = model.dmig[name].get_matrix(is_sparse=True)
        matrix = matrix.tocoo()
        for i, j, value in zip(matrix.row, matrix.col, matrix.data):  # noqa: B905
            add(kind, *rows[i], *columns[j], value)
print(json.dumps(out))
