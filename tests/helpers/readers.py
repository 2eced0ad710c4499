"""Readers of decks, written from the solvers' documents: each gives the matrix that a deck stands for.

All give {(node, direction): row} and dense matrices over these rows, in the deck's units.
"""

import re
from types import SimpleNamespace

import numpy as np


def places(*ends):
    nodes = sorted({int(n) for end in ends for n in end})
    return {(n, c): 3 * i + c - 1 for i, n in enumerate(nodes) for c in (1, 2, 3)}


def add_pair(A, place, a, b, block):
    i, j = ([place[n, c] for c in (1, 2, 3)] for n in (a, b))
    for rows, columns, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
        A[np.ix_(rows, columns)] += sign * block


def expected(deck, blocks):
    """The same matrix from the pairs."""
    one, two = deck.ends
    place = places(one, two)
    A = np.zeros((len(place),) * 2)
    for a, b, block in zip(one, two, blocks, strict=True):
        add_pair(A, place, int(a), int(b), block)
    return A


# ---- keywords of Abaqus and CalculiX


def keywords(text):
    """(keyword, options, data lines)."""
    out = []
    for line in text.splitlines():
        if line.startswith("**"):
            continue
        assert len(line) <= 256
        if line.startswith("*"):
            name, *rest = line[1:].split(",")
            options = dict(w.split("=") if "=" in w else (w, "") for w in (r.strip() for r in rest))
            out.append((name.strip().upper(), options, []))
        else:
            out[-1][2].append([w.strip() for w in line.split(",")])
    return out


def number(word, width=None):
    assert "." in word, f"{word} has no decimal point"
    assert width is None or len(word) <= width
    return float(word)


def axes_of(rows, width):
    v = np.array([number(w, width) for w in rows[0]])
    x = v[:3] / np.linalg.norm(v[:3])
    z = np.cross(x, v[3:])
    z /= np.linalg.norm(z)
    return np.stack([x, np.cross(z, x), z])


def one_way(text, keyword="SPRING", kind="SPRING2", width=20):
    """Springs or dashpots of one local direction each."""
    cards = keywords(text)
    axes = {o["NAME"]: axes_of(d, width) for k, o, d in cards if k == "ORIENTATION"}
    elements = {
        o["ELSET"]: [[int(w) for w in row] for row in d] for k, o, d in cards if k == "ELEMENT" and o["TYPE"] == kind
    }
    ids = [row[0] for rows in elements.values() for row in rows]
    assert len(ids) == len(set(ids))
    place = places(*[row[1:] for rows in elements.values() for row in rows])
    A = np.zeros((len(place),) * 2)
    for k, o, d in cards:
        if k != keyword:
            continue
        first, second = int(d[0][0]), int(d[0][1])
        assert first == second
        direction = axes[o["ORIENTATION"]][first - 1]
        for _, a, b in elements.pop(o["ELSET"]):
            add_pair(A, place, a, b, number(d[1][0], width) * np.outer(direction, direction))
    assert not elements, "element sets without a property"
    return A


def connectors(text):
    """Stiffness and structural damping of CARTESIAN connectors."""
    cards = keywords(text)
    axes = {o["NAME"]: axes_of(d, 20) for k, o, d in cards if k == "ORIENTATION"}
    elements = {o["ELSET"]: [[int(w) for w in row] for row in d] for k, o, d in cards if k == "ELEMENT"}
    behaviour, current = {}, None
    for k, o, d in cards:
        if k == "CONNECTOR BEHAVIOR":
            current = behaviour[o["NAME"]] = np.zeros((2, 3))
        elif k == "CONNECTOR ELASTICITY":
            current[0, int(o["COMPONENT"]) - 1] = number(d[0][0])
        elif k == "CONNECTOR DAMPING":
            assert o["TYPE"] == "STRUCTURAL"
            c = int(o["COMPONENT"]) - 1
            current[1, c] = number(d[0][0]) * current[0, c]
    place = places(*[row[1:] for rows in elements.values() for row in rows])
    A = np.zeros((2, len(place), len(place)))
    for k, o, d in cards:
        if k != "CONNECTOR SECTION":
            continue
        assert d[0][0] == "CARTESIAN"
        frame = axes[d[1][0]]
        for matrix, values in zip(A, behaviour[o["BEHAVIOR"]], strict=True):
            for _, a, b in elements[o["ELSET"]]:
                add_pair(matrix, place, a, b, frame.T @ np.diag(values) @ frame)
    return A


def matrix_input(text):
    """Matrices by name, and what *MATRIX ASSEMBLE takes them for."""
    cards = keywords(text)
    rows = {o["NAME"]: d for k, o, d in cards if k == "MATRIX INPUT" and o["TYPE"] == "SYMMETRIC"}
    place = places(*[[r[0], r[2]] for d in rows.values() for r in d])
    out = {}
    for name, d in rows.items():
        A = np.zeros((len(place),) * 2)
        for n1, c1, n2, c2, value in d:
            i, j = place[int(n1), int(c1)], place[int(n2), int(c2)]
            A[i, j] = A[j, i] = number(value)
        out[name] = A
    (use,) = [o for k, o, _ in cards if k == "MATRIX ASSEMBLE"]
    return {role: out[name] for role, name in use.items()}


# ---- Nastran, fields of 16 columns


def cards(text):
    """(name, fields) of cards in large fields."""
    out = []
    for line in text.splitlines():
        if line.startswith("$"):
            continue
        head, body = line[:8], line[8:].ljust(64)
        assert len(line) <= 72
        values = [body[16 * i : 16 * i + 16].strip() for i in range(4)]
        if head.startswith("*"):
            out[-1][1].extend(values)
        else:
            assert head.rstrip().endswith("*")
            out.append((head.strip(" *"), values))
    return out


def cbush(text):
    found = cards(text)
    frames, props = {}, {}
    for name, f in found:
        if name == "CORD2R":
            a, b, c = (np.array([number(w) for w in f[i : i + 3]]) for i in (2, 5, 8))
            assert f[1] == "0"
            z = (b - a) / np.linalg.norm(b - a)
            y = np.cross(z, c - a)
            y /= np.linalg.norm(y)
            frames[f[0]] = np.stack([np.cross(y, z), y, z])
        elif name == "PBUSH":
            # PID, then lines of eight small fields: flag, six values; the first line has PID before its flag
            lines = [f[1:8], f[9:16]]
            props[f[0]] = {line[0]: [number(w) if w else 0.0 for w in line[1:7]] for line in lines if line and line[0]}
    bushes = [f for name, f in found if name == "CBUSH"]
    place = places(*[[f[2], f[3]] for f in bushes])
    A = np.zeros((2, len(place), len(place)))
    for f in bushes:
        p, frame = props[f[1]], frames[f[7]]
        k = np.array(p["K"][:3])
        for matrix, values in zip(A, (k, k * p.get("GE", np.zeros(3))[:3]), strict=True):
            add_pair(matrix, place, int(f[2]), int(f[3]), frame.T @ np.diag(values) @ frame)
    return A


def celas2(text):
    found = [f for name, f in cards(text) if name == "CELAS2"]
    assert len({f[0] for f in found}) == len(found)
    place = places(*[[f[2], f[4]] for f in found])
    A = np.zeros((2, len(place), len(place)))
    for f in found:
        i, j = place[int(f[2]), int(f[3])], place[int(f[4]), int(f[5])]
        factor = number(f[6]) if len(f) > 6 and f[6] else 0.0
        for matrix, k in zip(A, (number(f[1]), factor * number(f[1])), strict=True):
            matrix[[i, j], [i, j]] += k
            matrix[i, j] -= k
            matrix[j, i] -= k
    return A


def dmig(text):
    found = [f for name, f in cards(text) if name == "DMIG"]
    heads = [f for f in found if f[1] == "0"]
    assert all(f[2:5] == ["6", "2", "0"] for f in heads)
    columns = [f for f in found if f[1] != "0"]
    place = places([f[1] for f in columns], [f[i] for f in columns for i in range(4, len(f), 4) if f[i]])
    out = {f[0]: np.zeros((len(place),) * 2) for f in heads}
    for f in columns:
        j = place[int(f[1]), int(f[2])]
        for k in range(4, len(f), 4):
            if f[k]:
                i = place[int(f[k]), int(f[k + 1])]
                out[f[0]][i, j] = out[f[0]][j, i] = number(f[k + 2])
    return out


# ---- MAPDL


def constant(i, j):
    """Number of the constant of MATRIX27 in row i and column j, both from 1, i <= j: upper triangle row by row."""
    return (i - 1) * 12 - (i - 1) * (i - 2) // 2 + (j - i) + 1


def whole(constants):
    A = np.zeros((12, 12))
    for i in range(1, 13):
        for j in range(i, 13):
            A[i - 1, j - 1] = A[j - 1, i - 1] = constants[constant(i, j) - 1]
    return A


def apdl(text):
    """Element types, real constants, elements (type, set, nodes) and turned nodes of a list of commands."""
    state = SimpleNamespace(types={}, keys={}, sets={}, elements=[], axes={}, kind=None, real=None, points={}, system=0)
    systems = {}
    for line in text.splitlines():
        if line.startswith("!") or line.startswith("/"):
            continue
        name, *words = line.split(",")
        if name == "ET":
            state.types[int(words[0])] = words[1]
        elif name == "KEYOPT":
            state.keys[tuple(map(int, words[:2]))] = int(words[2])
        elif name == "R":
            last = state.sets[int(words[0])] = [float(w) for w in words[1:]]
            assert len(words) <= 7
        elif name == "RMORE":
            assert len(words) == 6
            last.extend(float(w) for w in words)
        elif name == "TYPE":
            state.kind = int(words[0])
        elif name == "REAL":
            state.real = int(words[0])
        elif name == "EN":
            state.elements.append((state.kind, state.real, *map(int, words)))
        elif name == "N":
            state.points[words[0]] = np.array([float(w) for w in words[1:]])
        elif name == "CS":
            origin, x, plane = (state.points[w] for w in words[2:])
            x = (x - origin) / np.linalg.norm(x - origin)
            z = np.cross(x, plane - origin)
            z /= np.linalg.norm(z)
            systems[words[0]] = np.stack([x, np.cross(z, x), z])
        elif name == "CSYS":
            state.system = words[0]
        elif name == "NROTAT":
            state.axes[int(words[0])] = systems[state.system]
        else:
            assert name in ("*GET", "NDELE"), line
    return state


def matrix27(text):
    """Stiffness and damping, translations only; rotations must be empty."""
    found = apdl(text)
    place = places(*[e[3:] for e in found.elements])
    out = {4: np.zeros((len(place),) * 2), 5: np.zeros((len(place),) * 2)}
    for kind, real, _, a, b in found.elements:
        assert found.types[kind] == "MATRIX27"
        assert found.keys[kind, 2] == 0
        assert len(found.sets[real]) == 78
        A = whole(found.sets[real])
        keep = [0, 1, 2, 6, 7, 8]
        assert not np.delete(A, keep, axis=0).any()
        rows = [place[n, c] for n in (a, b) for c in (1, 2, 3)]
        out[found.keys[kind, 3]][np.ix_(rows, rows)] += A[np.ix_(keep, keep)]
    return out[4], out[5]


def combin14(text):
    found = apdl(text)
    place = places(*[e[3:] for e in found.elements])
    out = np.zeros((2, len(place), len(place)))
    for kind, real, _, a, b in found.elements:
        direction = found.axes[a][found.keys[kind, 2] - 1]
        assert np.array_equal(found.axes[a], found.axes[b])
        for matrix, value in zip(out, found.sets[real], strict=True):
            add_pair(matrix, place, a, b, value * np.outer(direction, direction))
    return out


# ---- Code_Aster


def aster(mail, comm):
    """Stiffness and hysteretic part; the commands are Python, the mesh a list of blocks that end in FINSF."""
    blocks, current = [], None
    for line in mail.splitlines():
        assert len(line) <= 130
        if line in ("FINSF", "FIN"):
            current = None
        elif current is None:
            current = (line.strip(), [])
            blocks.append(current)
        else:
            current[1].extend(line.split())
    cells, groups = {}, {}
    for name, words in blocks:
        if name == "SEG2":
            cells |= {words[i]: words[i + 1 : i + 3] for i in range(0, len(words), 3)}
        elif name in ("GROUP_MA", "GROUP_NO"):
            groups[words[0]] = words[1:]
            assert len(words[0]) <= 24
        assert all(len(w) <= 8 for w in words if re.match(r"[NMJ]\d+$", w))
    calls = {}

    def take(name):
        return lambda **options: calls.setdefault(name, options)

    scope = {"_F": dict, "MAIL": None} | {n: take(n) for n in ("AFFE_MODELE", "AFFE_CARA_ELEM")}
    exec(comm, scope)
    cara = calls["AFFE_CARA_ELEM"]
    frame = {}
    for one in cara["ORIENTATION"]:
        assert one["CARA"] == "VECT_X_Y"
        x, y = np.array(one["VALE"][:3]), np.array(one["VALE"][3:])
        for cell in groups[one["GROUP_MA"]]:
            frame[cell] = np.stack([x, y, np.cross(x, y)])
    place = places([int(n[1:]) for ends in cells.values() for n in ends])
    A = np.zeros((2, len(place), len(place)))
    for one in cara["DISCRET"]:
        if one["CARA"] != "K_T_D_L":
            continue
        assert one["REPERE"] == "LOCAL"
        for cell in groups[one["GROUP_MA"]]:
            a, b = (int(n[1:]) for n in cells[cell])
            block = frame[cell].T @ np.diag(one["VALE"]) @ frame[cell]
            add_pair(A[0], place, a, b, block)
            add_pair(A[1], place, a, b, one.get("AMOR_HYST", 0.0) * block)
    return A, blocks
