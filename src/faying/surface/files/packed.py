"""Scans that stand compressed in a file: gzip (.gz), and Digital Surf with compressed points."""

import gzip
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import BinaryIO

from faying.errors import FayingError, ReadError
from faying.surface.heights import BYTES, check_points

GZIP, DIGITAL_SURF, COMPRESSED = b"\x1f\x8b", b"DIGITAL SURF", b"DSCOMPRESSED"
HEADER = 512  # bytes of the header of Digital Surf, before the comment and the private zone
ZONES = 334  # where the header gives the length of these two, as two words
BLOCK = 1 << 20  # bytes that are unpacked at once
TIMES = 4  # as much memory as what is unpacked, while it is read: its text or bytes, and its numbers


@contextmanager
def unpacked(file: Path) -> Iterator[Path]:
    """The file, or a temporary one with what is compressed in it; faults that name the latter name the file.

    Raises ReadError where what is compressed is damaged, or does not fit into the memory.
    """
    with file.open("rb") as handle:
        head = handle.read(len(COMPRESSED))
    if not head.startswith((GZIP, COMPRESSED)):
        yield file
        return
    with TemporaryDirectory() as folder:
        plain = Path(folder) / file.name.removesuffix(".gz")
        try:
            with plain.open("wb") as out:
                (_gunzip if head.startswith(GZIP) else _points)(file, out)
        except (OSError, EOFError, zlib.error, struct.error) as fault:
            raise ReadError(f"{file}: it is compressed, and damaged or cut short ({fault}); copy it again") from None
        try:
            yield plain
        except FayingError as fault:
            raise type(fault)(str(fault).replace(str(plain), str(file))) from fault


def _gunzip(file: Path, out: BinaryIO) -> None:
    """Unpack a file of gzip."""
    size = 0
    with gzip.open(file) as packed:
        while block := packed.read(BLOCK):
            size += len(block)
            check_points(str(file), TIMES * size / BYTES)
            out.write(block)


def _points(file: Path, out: BinaryIO) -> None:
    """Write a file of Digital Surf with its points unpacked.

    Behind header, comment and private zone stand the number of pieces, the sizes of each, unpacked and packed, and the
    pieces, by zlib.
    """
    data = file.read_bytes()
    start = HEADER + sum(struct.unpack_from("<HH", data, ZONES))
    (count,) = struct.unpack_from("<I", data, start)
    sizes = [struct.unpack_from("<II", data, start + 4 + 8 * k) for k in range(count)]
    check_points(str(file), TIMES * sum(size for size, _ in sizes) / BYTES)
    out.write(DIGITAL_SURF + data[len(COMPRESSED) : start])
    at = start + 4 + 8 * count
    for size, packed in sizes:
        piece = zlib.decompressobj().decompress(data[at : at + packed], size)
        if len(piece) < size:
            raise EOFError(f"{len(piece)} of {size} bytes")
        out.write(piece)
        at += packed
