"""X3P (ISO 25178-72, formerly ISO 5436-2): a zip archive of main.xml and a block of binary heights, in metres.

Read by our own code rather than a library because the files come from strangers: sizes are checked before anything
is unpacked, XML with a document type (where entity attacks live) is refused, and every fault gets a sentence.
"""

import hashlib
import zipfile
from math import isfinite, prod
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.sax.saxutils import escape

import numpy as np

from faying.errors import InputError, ReadError, shown
from faying.surface.heights import Instrument, check_points
from faying.surface.scan import Profile, Scan
from faying.typing import Array

NUMBERS = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}
LARGEST_XML = 64 * 2**20  # with heights in it; ISO 25178-72 puts larger scans in a block of binary data
LARGEST_HEIGHTS = 4 * 2**30
NAMESPACE = "http://www.opengps.eu/2008/ISO5436_2"
TEMPLATE = """<?xml version="1.0" encoding="UTF-8" standalone="no" ?>
<p:ISO5436_2 xmlns:p="{namespace}" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" \
xsi:schemaLocation="{namespace} {namespace}/ISO5436_2.xsd">
  <Record1>
    <Revision>ISO5436 - 2000</Revision>
    <FeatureType>{kind}</FeatureType>
    <Axes>
      <CX><AxisType>I</AxisType><DataType>D</DataType><Increment>{dx!r}</Increment><Offset>0</Offset></CX>
      <CY><AxisType>I</AxisType><DataType>D</DataType><Increment>{dy!r}</Increment><Offset>0</Offset></CY>
      <CZ><AxisType>A</AxisType><DataType>{precision}</DataType>{z_axis}</CZ>
    </Axes>
  </Record1>
  <Record2>
    <Date>1980-01-01T00:00:00</Date>
    <Instrument>\
<Manufacturer>none</Manufacturer><Model>Faying</Model><Serial>0</Serial><Version>0</Version></Instrument>
    <CalibrationDate>1980-01-01T00:00:00</CalibrationDate>
    <ProbingSystem><Type>Software</Type><Identification>Faying</Identification></ProbingSystem>
    <Comment>{comment}</Comment>
  </Record2>
  <Record3>
    <MatrixDimension><SizeX>{nx}</SizeX><SizeY>{ny}</SizeY><SizeZ>1</SizeZ></MatrixDimension>
    <DataLink>
      <PointDataLink>bindata/data.bin</PointDataLink>
      <MD5ChecksumPointData>{digest}</MD5ChecksumPointData>
    </DataLink>
  </Record3>
  <Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4>
</p:ISO5436_2>
"""


def folder_of(names: list[str]) -> str:
    """The folder of an archive in which its main.xml stands, "" at the top: some programs zip the folder."""
    places = [name for name in names if name.rpartition("/")[2] == "main.xml" and not name.startswith("__MACOSX/")]
    return min(places, key=len, default="main.xml").removesuffix("main.xml")


def _member(archive: zipfile.ZipFile, name: str, limit: int, path: Path) -> bytes:
    try:
        info = archive.getinfo(folder_of(archive.namelist()) + name)
    except KeyError:
        raise ReadError(f"{path}: the X3P archive has no {name}; the file is incomplete, export it again") from None
    if info.file_size > limit:
        raise ReadError(f"{path}: {name} claims {info.file_size} bytes, more than the {limit} that are believable")
    try:
        return archive.read(info)
    except Exception as fault:  # a damaged archive fails in zlib, struct, or zipfile as it likes
        raise ReadError(f"{path}: {name} inside the X3P archive is damaged ({fault}); export the file again") from fault


def _text(root: ElementTree.Element, *names: str) -> str | None:
    found = root.find("/".join(f"{{*}}{name}" for name in names))  # in any namespace, or in none
    return None if found is None else (found.text or "").strip()


def _number(root: ElementTree.Element, path: Path, *names: str, default: float | None = None) -> float:
    text = _text(root, *names)
    if not text:
        if default is not None:
            return default
        raise ReadError(f"{path}: main.xml lacks {'/'.join(names)}; the X3P file is incomplete")
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise ReadError(f'{path}: {"/".join(names)} = "{text}" in main.xml is not a number')
    return value


def read(path: Path) -> Scan | Profile:
    """Read an X3P file: surface (SUR) or profile (PRF), heights in metres. ReadError where it is damaged."""
    try:
        archive = zipfile.ZipFile(path)
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as fault:
        raise ReadError(
            f"{path}: not an X3P (zip) archive that can be read ({fault}); the file is cut off or damaged"
        ) from fault
    with archive:
        xml = _member(archive, "main.xml", LARGEST_XML, path)
        if b"<!DOCTYPE" in xml or b"<!ENTITY" in xml:
            raise ReadError(f"{path}: main.xml declares a document type or entities, which X3P does not need; refused")
        check_points(str(path), float(xml.count(b"<")))  # a listed height has two tags, and takes as much as two points
        try:
            root = ElementTree.fromstring(xml)
        except (ElementTree.ParseError, ValueError, LookupError) as fault:
            raise ReadError(f"{path}: main.xml is not well-formed ({fault}); the file is damaged") from fault
        heights, missing = _heights(archive, root, path)
        kind = _text(root, "Record1", "FeatureType") or "SUR"
        if kind not in ("SUR", "PRF") or (kind == "PRF" and len(heights) > 1):
            size = f"{heights.shape[1]} x {len(heights)} points"
            raise ReadError(
                f"{path}: FeatureType {kind} of {size}; it is a map (SUR), or one profile (PRF), that is read"
            )
        offset = _number(root, path, "Record1", "Axes", "CZ", "Offset", default=0.0)
        whole = _text(root, "Record1", "Axes", "CZ", "DataType") in ("I", "L")
        step = _number(root, path, "Record1", "Axes", "CZ", "Increment", default=None if whole else 1.0)
        z = heights.astype(float) * (step if whole else 1.0) + offset
        z[missing | ~np.isfinite(z)] = np.nan
    increment = "" if whole or step in (0, 1) else f"heights in metres; the increment {step:g} is for integers"
    rotation = [one.text for one in root.findall("{*}Record1/{*}Axes/{*}Rotation/*")]
    plain = "".join((text or "").strip().rstrip("0").rstrip(".") or "0" for text in rotation)
    turned = (
        "" if plain in ("", "100010001") else f"its axes are stated to be turned by {rotation}, which is not applied"
    )
    notes = tuple(f"{path}: {one}" for one in (increment, turned) if one)
    makers = [_text(root, "Record2", "Instrument", part) for part in ("Manufacturer", "Model")]
    instrument = Instrument(name=" ".join(filter(None, makers)))
    spacing = [_spacing(root, path, axis) for axis in ("CX", "CY")[: 1 if kind == "PRF" else 2]]
    try:
        if kind == "PRF":
            return Profile(heights=z.ravel(), spacing=spacing[0], source=str(path), instrument=instrument, notes=notes)
        return Scan(heights=z, spacing=(spacing[0], spacing[1]), source=str(path), instrument=instrument, notes=notes)
    except InputError as fault:
        raise ReadError(f"{path}: {fault}") from fault


def _spacing(root: ElementTree.Element, path: Path, axis: str) -> float:
    kind = _text(root, "Record1", "Axes", axis, "AxisType") or "I"
    if kind != "I":
        raise ReadError(f"{path}: axis {axis} has type {kind}; only evenly spaced (incremental, I) axes can be used")
    return _number(root, path, "Record1", "Axes", axis, "Increment")


def _heights(archive: zipfile.ZipFile, root: ElementTree.Element, path: Path) -> tuple[Any, Any]:
    sizes = [_number(root, path, "Record3", "MatrixDimension", f"Size{axis}", default=1.0) for axis in "XYZ"]
    if any(size != int(size) or size < 1 for size in sizes) or sizes[2] != 1:
        raise ReadError(f"{path}: matrix of {sizes} points; whole numbers and one layer (SizeZ 1) are expected")
    nx, ny = int(sizes[0]), int(sizes[1])
    code = _text(root, "Record1", "Axes", "CZ", "DataType") or "D"
    if code not in NUMBERS:
        raise ReadError(f"{path}: heights of data type {code!r}; X3P knows {', '.join(NUMBERS)}")
    kind = np.dtype(NUMBERS[code])
    if prod((nx, ny, kind.itemsize)) > LARGEST_HEIGHTS:
        raise ReadError(f"{path}: a matrix of {nx} x {ny} points is more than can be read; crop the scan")
    check_points(str(path), float(nx * ny))
    link = _text(root, "Record3", "DataLink", "PointDataLink")
    missing = np.zeros((ny, nx), bool)
    if link:
        blob = _member(archive, link, LARGEST_HEIGHTS, path)
        stated = _text(root, "Record3", "DataLink", "MD5ChecksumPointData")
        if stated and hashlib.md5(blob, usedforsecurity=False).hexdigest().lower() != stated.lower():
            raise ReadError(f"{path}: the checksum of {link} does not match; the file is damaged, export it again")
        if len(blob) != nx * ny * kind.itemsize:
            raise ReadError(
                f"{path}: {link} has {len(blob)} bytes where {nx} x {ny} heights of {kind.itemsize} bytes are due; "
                "the file is cut off"
            )
        z = np.frombuffer(blob, kind).reshape(ny, nx)
        mask = _text(root, "Record3", "DataLink", "ValidPointsLink")
        if mask:
            bits = np.unpackbits(
                np.frombuffer(_member(archive, mask, LARGEST_HEIGHTS, path), np.uint8), bitorder="little"
            )
            if bits.size < nx * ny:
                raise ReadError(f"{path}: {mask} marks {bits.size} points of {nx * ny}; the file is cut off")
            missing = bits[: nx * ny].reshape(ny, nx) == 0
        return z, missing
    texts = [(found.text or "").strip() for found in root.iterfind("{*}Record3/{*}DataList/{*}Datum")]
    if len(texts) != nx * ny:
        raise ReadError(f"{path}: main.xml lists {len(texts)} heights where {nx} x {ny} are due")
    try:
        # a coordinate triple "x;y;z" or the height alone; an empty datum is a missing point
        listed = [float(text.split(";")[-1]) if text else float("nan") for text in texts]
    except ValueError as fault:
        raise ReadError(f"{path}: a height listed in main.xml is not a number ({fault})") from None
    return np.array(listed).reshape(ny, nx), missing


def write(scan: Scan | Profile, path: Path, *, precision: str = "F") -> None:
    """Write a scan as X3P: `precision` "F" (4 bytes), "D" (8), or "I"/"L" (2/4-byte steps of the height range).

    Raises InputError for other precisions, and for missing points in integer files.
    """
    if not isinstance(precision, str) or precision not in NUMBERS:
        raise InputError(f'precision = {shown(precision)}; allowed: "F", "D", "I", "L"')
    data, z_axis = _packed(scan.heights, precision)
    dx, dy = scan.spacing if isinstance(scan, Scan) else (scan.spacing, scan.spacing)
    xml = TEMPLATE.format(
        namespace=NAMESPACE,
        kind="SUR" if isinstance(scan, Scan) else "PRF",
        dx=dx,
        dy=dy,
        precision=precision,
        z_axis=z_axis,
        comment=escape(scan.source),
        nx=scan.heights.shape[-1],
        ny=len(scan.heights) if isinstance(scan, Scan) else 1,
        digest=hashlib.md5(data, usedforsecurity=False).hexdigest().upper(),
    ).encode()
    total = hashlib.md5(xml, usedforsecurity=False).hexdigest()
    members = {"main.xml": xml, "bindata/data.bin": data, "md5checksum.hex": f"{total} *main.xml\n".encode()}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in members.items():
            # a fixed date keeps the file the same from run to run
            info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, content)


def _packed(z: Array, precision: str) -> tuple[bytes, str]:
    """The heights as bytes, and the z axis's increment and offset where they are whole numbers."""
    if precision not in "IL":
        return z.astype(NUMBERS[precision]).tobytes(), ""
    if np.isnan(z).any():
        raise InputError("integer heights cannot mark missing points; write the scan with precision F or D")
    span = np.iinfo(np.dtype(NUMBERS[precision])).max
    offset = float(z.min() + z.max()) / 2
    step = max(float(np.ptp(z)) / (2 * span - 2), 1e-300)
    data = np.rint((z - offset) / step).astype(NUMBERS[precision]).tobytes()
    return data, f"<Increment>{step!r}</Increment><Offset>{offset!r}</Offset>"
