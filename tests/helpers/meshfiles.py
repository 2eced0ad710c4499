"""Mesh files of two blocks for the tests, written by hand in every format."""

import numpy as np

from faying.fe.elements import FACES, KINDS
from faying.fe.solids import kind_of

NUMBER0 = 100  # node numbers do not begin at 1, nor follow one another
ABAQUS = {"tet4": "C3D4", "tet10": "C3D10", "hex8": "C3D8I", "hex20": "C3D20R", "wedge6": "C3D6", "wedge15": "C3D15"}
NASTRAN = {"tet": "CTETRA", "hex": "CHEXA", "wedge": "CPENTA"}
ANSYS = {"tet4": 285, "tet10": 187, "hex8": 185, "hex20": 186, "wedge6": 185, "wedge15": 186}

# a study of the two blocks of `blocks.row`, in an Abaqus file
# two parts in a mesh, and the law between them; joints and bolts follow
LOW_AND_HIGH = """
[geometry]
mesh = "model.inp"
unit = "mm"
[part.low]
material = "45 steel"
[part.high]
material = "45 steel"
[surface]
D = 2.39
G = "1.53e-10 m"
scan_area = "16 mm^2"
[law]
model = "jk"
"""
STUDY = """
[geometry]
mesh = "model.inp"
unit = "mm"
[part.p0]
material = "45 steel"
[part.p1]
material = "45 steel"
[surface]
D = 2.39
G = "1.53e-10 m"
scan_area = "16 mm^2"
[[joint]]
name = "joint"
faces = ["p0.right", "p1.left"]
[[bolt]]
faces = ["p1.right", "p0.left"]
preload = ["1 kN", "3 kN"]
[modes]
count = 3
"""


def numbers(mesh):
    return NUMBER0 + 3 * np.arange(len(mesh.points))


def solids(mesh):
    """(part, number, kind, node numbers) of every element."""
    number, n = 7, numbers(mesh)
    for part, blocks in mesh.parts.items():
        for cells in blocks:
            for cell in cells:
                number += 2
                yield part, number, kind_of(cells), n[cell].tolist()


def wrapped(words, per=8):
    return [
        ", ".join(map(str, words[k : k + per])) + ("," if k + per < len(words) else "")
        for k in range(0, len(words), per)
    ]


def sides(mesh, name):
    """(element number, side) of a face."""
    n = numbers(mesh)
    wanted = {frozenset(n[f[: FACES[block.shape[1]].corners]].tolist()) for block in mesh.faces[name] for f in block}
    for _, number, kind, nodes in solids(mesh):
        for i, side in enumerate(KINDS[kind].sides):
            if frozenset(nodes[k] for k in side if k < KINDS[kind].corners) in wanted:
                yield number, i, kind, nodes


def abaqus(mesh, unit=1e-3, faces="surface"):
    n = numbers(mesh)
    lines = ["*HEADING", "two blocks", "** a comment", "*Node, nset=NALL"]
    lines += [f"{i}, {x:.9g}, {y:.9g}, {z:.9g}" for i, (x, y, z) in zip(n, mesh.points / unit, strict=True)]
    last = None
    for part, number, kind, nodes in solids(mesh):
        if (part, kind) != last:
            lines.append(f"*Element, type={ABAQUS[kind]},\n elset={part}")
            last = (part, kind)
        lines += wrapped([number, *nodes])
    for name in mesh.faces:
        if faces == "nodes":
            lines += [f"*NSET, NSET={name}", *wrapped(n[mesh.face_nodes(name)].tolist())]
            continue
        by_side = {}
        for number, side, _, _ in sides(mesh, name):
            by_side.setdefault(side, []).append(number)
        for side, some in by_side.items():
            lines += [f"*ELSET, ELSET=_{name}_S{side + 1}", *wrapped(some)]
        lines.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
        lines += [f"_{name}_S{side + 1}, S{side + 1}" for side in by_side]
    return "\n".join(lines) + "\n"


def assembly(mesh, unit=1e-3):
    """Every part from its own numbering, moved into place: Abaqus/CAE's structure."""
    lines, placed = ["*Heading"], []
    for part, blocks in mesh.parts.items():
        nodes = mesh.part_nodes(part)
        local = {int(node): i + 1 for i, node in enumerate(nodes)}
        shift = np.array([0.02, -0.01, 0.005])
        turned = mesh.points[nodes] - shift
        turned = np.column_stack([-turned[:, 1], turned[:, 0], turned[:, 2]])  # a quarter turn about z
        lines += [f"*Part, name={part}-part", "*Node"]
        lines += [f"{i + 1}, {x:.12g}, {y:.12g}, {z:.12g}" for i, (x, y, z) in enumerate(turned / unit)]
        number = 0
        for cells in blocks:
            lines.append(f"*Element, type={ABAQUS[kind_of(cells)]}")
            for cell in cells:
                number += 1
                lines += wrapped([number, *(local[int(c)] for c in cell)])
        lines += ["*Elset, elset=all, generate", f"1, {number}, 1", "*Solid Section, elset=all, material=steel", ","]
        lines += ["*End Part", "**"]
        s = shift / unit
        # turned back by -90 degrees about an axis through the shifted origin
        placed += [
            f"*Instance, name={part}, part={part}-part",
            f"{s[0]}, {s[1]}, {s[2]}",
            f"{s[0]}, {s[1]}, {s[2]}, {s[0]}, {s[1]}, {s[2] + 1}, -90.",
            "*End Instance",
        ]
        for name, owner in mesh.face_part.items():
            if owner == part:
                placed += [f"*Nset, nset={name.replace('.', '-')}, instance={part}"]
                placed += wrapped([local[int(k)] for k in mesh.face_nodes(name)])
    return "\n".join([*lines, "*Assembly, name=Assembly", *placed, "*End Assembly"]) + "\n"


def nastran_order(kind):
    if kind == "hex20":
        return [*range(12), *range(16, 20), *range(12, 16)]
    if kind == "wedge15":
        return [*range(9), *range(12, 15), *range(9, 12)]
    return range(KINDS[kind].count)


def nastran(mesh, unit=1e-3, field="small", faces="load"):
    n = numbers(mesh)

    def card(name, *words):
        words = [str(w) for w in words]
        if field == "free":
            lines = [",".join([name if k == 0 else "+", *words[k : k + 8]]) for k in range(0, len(words), 8)]
        elif field == "large":
            cut = [words[k : k + 4] for k in range(0, len(words), 4)]
            lines = [f"{name + '*' if k == 0 else '*':<8}" + "".join(f"{w:<16}" for w in c) for k, c in enumerate(cut)]
        else:
            lines = [
                f"{name if k == 0 else '+':<8}" + "".join(f"{w:<8}" for w in words[k : k + 8])
                for k in range(0, len(words), 8)
            ]
        return lines

    def real(x):
        text = f"{x:.5f}" if field == "small" else f"{x:.9E}".replace("E", "D" if field == "free" else "E")
        return text if field != "small" else text[:8]

    bulk = []
    for i, point in zip(n, mesh.points / unit, strict=True):
        bulk += card("GRID", i, "", *(real(x) for x in point))
    property_of = {part: i + 1 for i, part in enumerate(mesh.parts)}
    for part, number, kind, nodes in solids(mesh):
        bulk += card(
            NASTRAN[KINDS[kind].shape.name], number, property_of[part], *(nodes[i] for i in nastran_order(kind))
        )
    head = ["SOL 103", "CEND"]
    for k, name in enumerate(mesh.faces):
        if faces == "load":
            for number, side, kind, nodes in sides(mesh, name):
                here = [i for i in KINDS[kind].sides[side] if i < KINDS[kind].corners]
                if KINDS[kind].shape.name == "tet":
                    other = next(nodes[i] for i in range(4) if i not in here)
                else:
                    other = nodes[here[2]] if len(here) == 4 else ""
                bulk += card("PLOAD4", k + 1, number, "1.0", "", "", "", nodes[here[0]], other)
        elif faces == "set":
            bulk += card("SET1", k + 1, *n[mesh.face_nodes(name)].tolist())
        else:
            head.append(f"SET {k + 1} = " + ",\n".join(map(str, n[mesh.face_nodes(name)])))
    return "\n".join([*head, "BEGIN BULK", "$ comment", *bulk, "ENDDATA"]) + "\n"


GMSH = {
    "tet4": (4, range(4)),
    "hex8": (5, range(8)),
    "wedge6": (6, range(6)),
    "tet10": (11, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
    "hex20": (17, [*range(8), 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14]),
    "wedge15": (18, [*range(6), 6, 8, 12, 7, 13, 14, 9, 11, 10]),
}
GMSH_FACE = {3: 2, 4: 3, 6: 9, 8: 16}


def gmsh(mesh, unit=1e-3, version="2.2"):
    n = numbers(mesh)
    parts, faces = list(mesh.parts), list(mesh.faces)
    lines = ["$MeshFormat", f"{version} 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(parts) + len(faces))]
    lines += [f'2 {i + 1} "{name}"' for i, name in enumerate(faces)]
    lines += [f'3 {i + 50} "{name}"' for i, name in enumerate(parts)]
    lines.append("$EndPhysicalNames")
    rows = {}
    for part, number, kind, nodes in solids(mesh):
        code, order = GMSH[kind]
        rows.setdefault((3, parts.index(part) + 50, code), []).append((number, [nodes[i] for i in order]))
    count = 10000
    for i, name in enumerate(faces):
        for block in mesh.faces[name]:
            for f in block:
                count += 1
                turned = n[f][::-1] if count % 2 and len(f) in (3, 4) else n[f]  # gmsh's normals may look inwards
                rows.setdefault((2, i + 1, GMSH_FACE[len(f)]), []).append((count, turned.tolist()))
    total = sum(map(len, rows.values()))
    if version == "2.2":
        lines += ["$Nodes", str(len(n))]
        lines += [f"{i} {x:.16g} {y:.16g} {z:.16g}" for i, (x, y, z) in zip(n, mesh.points / unit, strict=True)]
        lines += ["$EndNodes", "$Elements", str(total)]
        for (_, tag, code), some in rows.items():
            lines += [f"{number} {code} 2 {tag} {tag} " + " ".join(map(str, nodes)) for number, nodes in some]
        return "\n".join([*lines, "$EndElements"]) + "\n"
    lines += ["$Entities", f"0 0 {len(faces)} {len(parts)}"]
    lines += [f"{i + 1} 0 0 0 1 1 1 1 {i + 1} 0" for i in range(len(faces))]
    lines += [f"{i + 50} 0 0 0 1 1 1 1 {i + 50} 0" for i in range(len(parts))]
    lines += ["$EndEntities", "$Nodes", f"1 {len(n)} {n.min()} {n.max()}", f"3 50 0 {len(n)}", *map(str, n)]
    lines += [f"{x:.16g} {y:.16g} {z:.16g}" for x, y, z in mesh.points / unit]
    lines += ["$EndNodes", "$Elements", f"{len(rows)} {total} 1 {count}"]
    for (dimension, tag, code), some in rows.items():
        lines.append(f"{dimension} {tag} {code} {len(some)}")
        lines += [f"{number} " + " ".join(map(str, nodes)) for number, nodes in some]
    return "\n".join([*lines, "$EndElements"]) + "\n"


def gmsh_binary(mesh, unit=1e-3, version="4.1", order="<"):
    """The text of `gmsh`, its numbers packed as the format says: int 4 bytes, size_t and double 8."""
    import struct

    def pack(kinds, words):
        return struct.pack(
            order + kinds, *(float(w) if k == "d" else int(w) for k, w in zip(kinds, words, strict=True))
        )

    lines = gmsh(mesh, unit, version).splitlines()
    out = f"$MeshFormat\n{version} 1 8\n".encode() + struct.pack(order + "i", 1) + b"\n$EndMeshFormat\n"
    start = lines.index("$PhysicalNames")
    out += ("\n".join(lines[start : lines.index("$EndPhysicalNames") + 1]) + "\n").encode()

    def body(name):
        rows = lines[lines.index(f"${name}") + 1 : lines.index(f"$End{name}")]
        return iter([row.split() for row in rows])

    if version == "2.2":
        rows = list(body("Nodes"))
        out += f"$Nodes\n{rows[0][0]}\n".encode() + b"".join(pack("iddd", r) for r in rows[1:]) + b"\n$EndNodes\n"
        rows = list(body("Elements"))
        out += f"$Elements\n{rows[0][0]}\n".encode()
        for r in rows[1:]:  # each with a head of its own
            out += pack("iii", (r[1], 1, r[2])) + pack("i" * (len(r) - 2), (r[0], *r[3:]))
        return out + b"\n$EndElements\n"
    rows = body("Entities")
    counts = next(rows)
    out += b"$Entities\n" + pack("QQQQ", counts)
    for r in rows:
        out += pack("idddddd", r[:7]) + pack("Q", r[7:8]) + pack("i", r[8:9]) + pack("Q", r[9:10])
    rows = body("Nodes")
    out += b"\n$EndEntities\n$Nodes\n" + pack("QQQQ", next(rows))
    head = next(rows)
    count = int(head[3])
    out += pack("iiiQ", head) + b"".join(pack("Q", next(rows)) for _ in range(count))
    out += b"".join(pack("ddd", next(rows)) for _ in range(count))
    rows = body("Elements")
    head = next(rows)
    out += b"\n$EndNodes\n$Elements\n" + pack("QQQQ", head)
    for _ in range(int(head[0])):
        block = next(rows)
        out += pack("iiiQ", block)
        for _ in range(int(block[3])):
            row = next(rows)
            out += pack("Q" * len(row), row)
    return out + b"\n$EndElements\n"


UNV = {
    "tet4": (111, range(4)),
    "wedge6": (112, range(6)),
    "hex8": (115, range(8)),
    "tet10": (118, [0, 4, 1, 5, 2, 6, 7, 8, 9, 3]),
    "wedge15": (113, [0, 6, 1, 7, 2, 8, 12, 13, 14, 3, 9, 4, 10, 5, 11]),
    "hex20": (116, [0, 8, 1, 9, 2, 10, 3, 11, 16, 17, 18, 19, 4, 12, 5, 13, 6, 14, 7, 15]),
}
UNV_FACE = {3: (91, range(3)), 4: (94, range(4)), 6: (92, [0, 3, 1, 4, 2, 5]), 8: (95, [0, 4, 1, 5, 2, 6, 3, 7])}


def unv(mesh, unit=1e-3, faces="shells"):
    """Universal file as SALOME writes it: nodes round the sides, corner, middle, corner; groups of everything."""
    n = numbers(mesh)
    lines = ["    -1", "  2411"]
    for i, place in zip(n, mesh.points / unit, strict=True):
        lines += [f"{i:10d}{1:10d}{1:10d}{11:10d}", "".join(f"{x:25.16E}".replace("E", "D") for x in place)]
    lines += ["    -1", "    -1", "  2412", f"{9999:10d}{11:10d}{1:10d}{1:10d}{7:10d}{2:10d}", f"{0:10d}{1:10d}{1:10d}"]
    lines.append(f"{n[0]:10d}{n[1]:10d}")
    groups = {}

    def element(number, code, nodes):
        lines.append(f"{number:10d}{code:10d}{1:10d}{1:10d}{7:10d}{len(nodes):10d}")
        lines.extend("".join(f"{w:10d}" for w in nodes[k : k + 8]) for k in range(0, len(nodes), 8))

    for part, number, kind, nodes in solids(mesh):
        code, order = UNV[kind]
        element(number, code, [nodes[i] for i in order])
        groups.setdefault(part, []).append((8, number))
    count = 10000
    for name in mesh.faces:
        if faces == "nodes":
            groups[name] = [(7, i) for i in n[mesh.face_nodes(name)]]
            continue
        for block in mesh.faces[name]:
            for f in block:
                count += 1
                code, order = UNV_FACE[len(f)]
                element(count, code, [n[f[i]] for i in order])
                groups.setdefault(name, []).append((8, count))
    lines += ["    -1", "    -1", "  2467"]
    for k, (name, some) in enumerate(groups.items(), 1):
        lines += ["".join(f"{w:10d}" for w in (k, 0, 0, 0, 0, 0, 0, len(some))), name]
        words = [f"{kind:10d}{tag:10d}{0:10d}{0:10d}" for kind, tag in some]
        lines += ["".join(words[k : k + 2]) for k in range(0, len(words), 2)]
    return "\n".join([*lines, "    -1"]) + "\n"


DOUBLED = {
    "wedge6": [0, 1, 2, 2, 3, 4, 5, 5],
    "wedge15": [0, 1, 2, 2, 3, 4, 5, 5, 6, 7, 2, 8, 9, 10, 5, 11, 12, 13, 14, 14],
}


def ansys(mesh, unit=1e-3):
    n = numbers(mesh)
    lines = ["/COM,ANSYS RELEASE 2021", "/PREP7"]
    kinds = sorted({kind for _, _, kind, _ in solids(mesh)})
    lines += [f"ET,{i + 1},SOLID{ANSYS[kind]}" for i, kind in enumerate(kinds)]
    lines += [f"NBLOCK,6,SOLID,{n.max()},{len(n)}", "(3i9,6e21.13e3)"]
    for i, point in zip(n, mesh.points / unit, strict=True):
        last = max((k for k in range(3) if point[k] != 0), default=-1)  # zeros at the end of a line are left out
        lines.append(
            f"{i:9d}{0:9d}{0:9d}"
            + "".join(f"{x:21.13E}".replace("E+", "E+0").replace("E-", "E-0")[-21:] for x in point[: last + 1])
        )
    every = list(solids(mesh))
    lines += ["N,R5.3,LOC,       -1,", f"EBLOCK,19,SOLID,{every[-1][1]},{len(every)}", "(19i9)"]
    for _, number, kind, nodes in every:
        held = [nodes[i] for i in DOUBLED.get(kind, range(len(nodes)))]
        words = [1, kinds.index(kind) + 1, 1, 1, 0, 0, 0, 0, len(held), 0, number, *held[:8]]
        lines.append("".join(f"{w:9d}" for w in words))
        if held[8:]:
            lines.append("".join(f"{w:9d}" for w in held[8:]))
    lines.append(f"{-1:9d}")

    def component(name, what, values):
        packed, k = [], 0
        while k < len(values):
            end = k
            while end + 1 < len(values) and values[end + 1] == values[end] + 1:
                end += 1
            packed += [values[k]] if end == k else [values[k], -values[end]]
            k = end + 1
        out = [f"CMBLOCK,{name},{what},{len(packed):8d}", "(8i10)"]
        return out + ["".join(f"{v:10d}" for v in packed[k : k + 8]) for k in range(0, len(packed), 8)]

    for part in mesh.parts:
        lines += component(part.upper(), "ELEM", [number for p, number, _, _ in every if p == part])
    for name in mesh.faces:
        lines += component(name.replace(".", "_").upper(), "NODE", sorted(n[mesh.face_nodes(name)].tolist()))
    return "\n".join([*lines, "FINISH"]) + "\n"
