"""What kind a file is: the one table of the kinds that Faying knows, by what their files hold."""

import re
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from faying.errors import ReadError
from faying.files import SEAL

HEAD = 1 << 16  # bytes that are looked at: the first groups of HDF5 and the first keyword of a deck are in them
LENGTH = len(SEAL) + 64  # of the checksum of a file that Faying has saved, at its end
Use = Literal["geometry", "mesh", "matrices", "scan", "test", "study", "result", "numbers"]


@dataclass(frozen=True, kw_only=True)
class FileKind:
    """A kind of file: what it is in words, what tells it, what it may be taken for.

    holds: a regular expression that the first bytes match. suffixes: decide where several kinds match, or none. reader:
    module of `faying.decks` that reads its meshes or matrices.
    """

    says: str
    holds: str
    suffixes: tuple[str, ...] = ()
    serves: tuple[Use, ...] = ()
    reader: str = ""


_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d+)?"
# two numbers or more in a line
_ROW = rf"(?:[ \t]*(?:(?:#|\*\*).*)?\n)*[ \t]*{_NUMBER}(?:[ \t]*+[,;]|[ \t])[ \t]*+{_NUMBER}"
_POINTS = rf"(?:(?:[ \t]*(?:#.*)?\n)*[ \t\"']*[xyz]\b.*\n)?{_ROW}"
_OPERATORS = r"\*(?:SET|GET|DIM|DO|IF|USE|CREATE|CFOPEN)"  # of MAPDL's language
_COMMANDS = r"/(?:BATCH|COM|PREP7|NOPR|TITLE|FILNAME|WB|SOLU|CLEAR|UNITS|CONFIG)|FINI(?:SH)?"
_MAPDL = rf"(?:[ \t]*(?:!.*)?\n)*[ \t]*(?:(?:{_COMMANDS}|{_OPERATORS})\b|(?:ET|(?:ET|N|E|CM)BLOCK)[ \t]*,)"
_PARTS = r"HEADING|PREPRINT|PARAMETER|INCLUDE|PART|ASSEMBLY|INSTANCE|SYSTEM|NODE|ELEMENT|NSET|ELSET|SURFACE|TRANSFORM"
_STEPS = r"BOUNDARY|MATERIAL|ORIENTATION|AMPLITUDE|EQUATION|SOLID SECTION|RESTART|STEP"
_UCD = r"(?:#.*\n)*[ \t]*\d+(?:[ \t]+\d+){4}[ \t]*\n"
_ABAQUS = rf"(?:[ \t]*(?:\*\*.*)?\n)*[ \t]*\*[ \t]*(?:{_PARTS}|{_STEPS})\b|(?!{_UCD}){_ROW}"  # rows: to include
_CARDS = r"GRID|C(?:TETRA|HEXA|PENTA|TRIA|QUAD|ORD)\w*|DMIG|MAT1|PSOLID|PLOAD4|SET1|RBE[23]|CONM2|SPC1?|EIGRL"
_CONTROL = r"BEGIN[ \t]+BULK|CEND|ENDDATA|SOL[ \t]+\w+|NASTRAN|ASSIGN|INCLUDE[ \t]+['\"].*"
_BEFORE = r"(?:[ \t]*(?:\$.*|(?:ID|TIME|PARAM)\b.*|[A-Z][^=\n]*=.*)?\n)*+"  # lines that other programs have, too
_NASTRAN = rf"{_BEFORE}[ \t]*(?:(?:{_CONTROL})\s|(?:{_CARDS})\*?[ \t,])"
_TOML = r"(?=(?:[ \t]*(?:#.*)?\n)*[ \t]*(?:\[+[\w.\" -]+\]|[\w.\"-]+[ \t]*=))[\s\S]*?^[ \t]*\[geometry\]"
_BULK = (".bdf", ".nas", ".dat", ".pch")
_XML = r"\s*(?:<[?!][^>]*>\s*)*<VTKFile\b"
_SCANS = r"DIGITAL SURF|DSCOMPRESSED|VCA DATA|[ab]BCR-|Alicona|II\*\0|MM\0\*|\x93NUMPY|CDF|\x88\x1b\x03"
_ENDS = (".sur", ".opd", ".opdx", ".plux", ".sdf", ".al3d", ".tif", ".npy", ".nc")
_MED = r"\x89HDF[\s\S]*(?:INFOS_GENERALES|ENS_MAA)"
_RECORD = rf"\x89HDF[\s\S]*{SEAL.decode()}"  # the checksum behind what Faying saves
_GMSH = r"(?:\$Comments[\s\S]*?\$EndComments)?\s*\$(?:MeshFormat|NOD)\b"
_SETS = r"\s*-1[ \t]*\n[ \t]*\d{1,4}b?\s"
_TESTED = rf"(?={_SETS})(?![\s\S]*^ *-1 *\n *(?:780|2412)\s)[\s\S]*^ *-1 *\n *(?:55|58b?)\s"  # without elements

STEP = FileKind(says="a STEP file", holds=r"[\s\S]{0,52}ISO-10303-21", suffixes=(".step", ".stp"), serves=("geometry",))
ABAQUS = FileKind(
    says="an input file of Abaqus or CalculiX", holds=_ABAQUS, suffixes=(".inp",), serves=("mesh",), reader="abaqus"
)
NASTRAN = FileKind(
    says="an input file of Nastran", holds=_NASTRAN, suffixes=_BULK, serves=("mesh", "matrices"), reader="nastran"
)
VTU = FileKind(says="a VTU file", holds=_XML, suffixes=(".vtu",), serves=("mesh",), reader="vtk")
MED = FileKind(says="a MED file", holds=_MED, suffixes=(".med",), serves=("mesh",), reader="vtk")
RESULT = FileKind(says="a result of Faying", holds=_RECORD, suffixes=(".nc",), serves=("result",))
STUDY = FileKind(says="a study", holds=_TOML, suffixes=(".toml",), serves=("study",))
X3P = FileKind(says="an X3P file", holds=r"PK[\s\S]*\bmain\.xml$", suffixes=(".x3p",), serves=("scan",))
MARKET = FileKind(says="a matrix in Matrix Market", holds=r"%%MatrixMarket", suffixes=(".mtx",), serves=("matrices",))
SPARSE = FileKind(says="a matrix of SciPy", holds=r"PK[\s\S]*^format\.npy$", suffixes=(".npz",), serves=("matrices",))
# of those that match, the first with a fitting suffix is taken, else the first
KINDS = (
    FileKind(
        says="a text of points or heights", holds=_POINTS, suffixes=(".xyz", ".asc", ".txt"), serves=("scan", "numbers")
    ),
    FileKind(says="a pointer of Git LFS (get the file itself by git lfs pull)", holds="version https://git-lfs"),
    *(STEP, ABAQUS, NASTRAN, VTU, MED, RESULT, STUDY, X3P, MARKET, SPARSE),
    FileKind(says="an input file of Ansys (MAPDL)", holds=_MAPDL, suffixes=(".cdb",), serves=("mesh",), reader="mapdl"),
    FileKind(says="a mesh of Gmsh", holds=_GMSH, suffixes=(".msh",), serves=("mesh",), reader="gmsh"),
    FileKind(says="a hammer test in a universal file", holds=_TESTED, suffixes=(".uff",), serves=("test",)),
    FileKind(says="a universal file", holds=_SETS, suffixes=(".unv", ".uff"), serves=("mesh", "test"), reader="unv"),
    FileKind(says="a VTK file", holds=r"# vtk DataFile", suffixes=(".vtk",), serves=("mesh",), reader="vtk"),
    FileKind(says="a matrix of CalculiX", holds=_ROW, suffixes=(".sti",), serves=("matrices",), reader="calculix"),
    FileKind(says="an instrument's file", holds=_SCANS, suffixes=_ENDS, serves=("scan",)),
    FileKind(says="a container of scans", holds=r"PK[\s\S]*^(?:meta\.yml|index\.json)$", serves=("scan",)),
    FileKind(says="a file packed by gzip", holds=r"\x1f\x8b", suffixes=(".gz",), serves=("scan",)),
    FileKind(says="a table as text", holds="(?!)", suffixes=(".csv", ".dat"), serves=("test", "numbers")),
    FileKind(says="a mesh of Ansys Fluent", holds=r"\s*\([012][ \t]+[\"\d]"),
    FileKind(says="an input file of LS-DYNA", holds=r"(?:\$.*\n)*\*KEYWORD\b"),
    FileKind(says="a UCD file of AVS", holds=_UCD, suffixes=(".inp",)),
    FileKind(says="an IGES file", holds=r".{72}S {6}1", suffixes=(".igs", ".iges")),
)


def kind_held(path: Path, *, name: str = "") -> FileKind | None:
    """The kind that a file is by what it holds, None where no kind is found in it; name: if not that of the path."""
    head, suffix = _head(path), Path(name or path).suffix.lower()
    found = [kind for kind in KINDS if re.match(kind.holds.encode(), head, re.M | re.I)]
    return min(found, key=lambda kind: suffix not in kind.suffixes, default=None)


def kind_of(path: Path, *uses: Use, name: str = "") -> FileKind | None:
    """The kind of a file by what it holds, else by its suffix, where kinds that serve the uses go before others."""
    named = [kind for kind in KINDS if Path(name or path).suffix.lower() in kind.suffixes]
    return kind_held(path, name=name) or min(named, key=lambda kind: {*uses}.isdisjoint(kind.serves), default=None)


def taken(path: Path, *uses: Use, name: str = "") -> FileKind:
    """The kind of a file that serves one of the uses. Raises ReadError that says what it is, where it serves none."""
    kind = kind_of(path, *uses, name=name)
    known = [one for one in KINDS if not {*uses}.isdisjoint(one.serves)]
    if kind in known:
        return kind
    if kind is not None:
        says = ", ".join(one.says for one in known)
        raise ReadError(f"{name or path} is {kind.says}, which is not read here; give one of these: {says}")
    suffix = Path(name or path).suffix or "(none)"
    ends = ", ".join(dict.fromkeys(end for one in known for end in one.suffixes))
    raise ReadError(f"{name or path}: files of the kind {suffix} are not known; the known ones are {ends}")


def _head(path: Path) -> bytes:
    """The first bytes of a file with \\n at the ends of lines; of HDF5 the last ones, too; of an archive its names."""
    if not path.is_file():
        return b""
    try:
        with path.open("rb") as file:
            head = file.read(HEAD)
            file.seek(max(HEAD, path.stat().st_size - LENGTH))
            head += file.read() if head.startswith(b"\x89HDF") else b""
        head = head.removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        if head.startswith(b"PK"):
            with zipfile.ZipFile(path) as archive:
                head = "\n".join(["PK", *archive.namelist()]).encode(errors="replace")
    except (OSError, zipfile.BadZipFile, ValueError, NotImplementedError):
        return b""
    return head
