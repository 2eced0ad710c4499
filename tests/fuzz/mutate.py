"""Mutations of a file: cut, flipped, dropped, doubled, and numbers or values swapped for bad ones."""

import io
import re
import zipfile

NUMBER = re.compile(rb"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eEdD][-+]?\d+)?")
BAD_NUMBERS = [
    b"nan",
    b"inf",
    b"-inf",
    b"1e400",
    b"-1",
    b"0",
    b"1e300",
    b"1e-320",
    b"99999999999999999999",
    b"2147483648",
    b"1000000000",
    b"-0.5",
    b"1.7",
    b"",
    b"x",
    b"1,5",
    b"0x1F",
]
BAD_VALUES = [
    b"true",
    b"[]",
    b"{}",
    b'""',
    b"-1",
    b"1e999",
    b"nan",
    b'"nan"',
    b"[1, 2, 3]",
    b'["1 kN", 2]',
    b"1979-05-27",
    b'"10**10**10 N"',
    b'"-5 kN"',
    b'"1e400 mm"',
    b'"x"',
    b"9" * 30,
    b"[[[[1]]]]",
]


def truncate(blob, rng):
    return blob[: int(rng.integers(0, max(len(blob), 1)))]


def flip(blob, rng):
    out = bytearray(blob)
    for at in rng.integers(0, len(out), int(rng.integers(1, 9))):
        out[at] ^= 1 << int(rng.integers(0, 8))
    return bytes(out)


def drop(blob, rng):
    at, size = int(rng.integers(0, len(blob))), int(rng.integers(1, max(2, len(blob) // 8)))
    return blob[:at] + blob[at + size :]


def double(blob, rng):
    at, size = int(rng.integers(0, len(blob))), int(rng.integers(1, max(2, len(blob) // 8)))
    return blob[: at + size] + blob[at : at + size] + blob[at + size :]


def drop_line(blob, rng):
    lines = blob.split(b"\n")
    del lines[int(rng.integers(0, len(lines)))]
    return b"\n".join(lines)


def double_line(blob, rng):
    lines = blob.split(b"\n")
    at = int(rng.integers(0, len(lines)))
    return b"\n".join([*lines[:at], lines[at], *lines[at:]])


def swap_number(blob, rng):
    found = list(NUMBER.finditer(blob))
    if not found:
        return flip(blob, rng)
    for match in sorted(
        (found[int(k)] for k in set(rng.integers(0, len(found), int(rng.integers(1, 4))).tolist())),
        key=lambda m: -m.start(),
    ):
        blob = blob[: match.start()] + BAD_NUMBERS[int(rng.integers(0, len(BAD_NUMBERS)))] + blob[match.end() :]
    return blob


def swap_value(blob, rng):
    """A value of a TOML file for one of another type or size; in other files, a number."""
    found = list(re.finditer(rb"(?<== )[^\n#]+", blob))
    if not found:
        return swap_number(blob, rng)
    match = found[int(rng.integers(0, len(found)))]
    return blob[: match.start()] + BAD_VALUES[int(rng.integers(0, len(BAD_VALUES)))] + blob[match.end() :]


def long_run(blob, rng):
    """A stretch of one sign, which a careless search runs over again from each of its places."""
    at, sign = int(rng.integers(0, len(blob) + 1)), rng.choice(list(" -1A,\t.(_\n$*e[#<"))
    return blob[:at] + sign.encode() * int(rng.choice([50, 3000, 100_000])) + b"x" + blob[at:]


def shuffle_lines(blob, rng):
    """Some lines in another order."""
    lines = blob.split(b"\n")
    at = int(rng.integers(0, len(lines)))
    some = lines[at : at + 20]
    return b"\n".join([*lines[:at], *(some[k] for k in rng.permutation(len(some))), *lines[at + 20 :]])


LINES = (drop_line, double_line, shuffle_lines)
KINDS = (truncate, flip, drop, double, *LINES, swap_number, swap_number, swap_value, long_run)


def mutated(blob, rng):
    """Return the name of the mutation and the mutated file; half of the archives are mutated inside."""
    kind = KINDS[int(rng.integers(0, len(KINDS)))]
    if blob[:2] == b"PK" and rng.random() < 0.6:
        with zipfile.ZipFile(io.BytesIO(blob)) as old:
            members = {name: old.read(name) for name in old.namelist()}
        name = list(members)[int(rng.integers(0, len(members)))]
        members[name] = kind(members[name], rng) if members[name] else b"x"
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w") as new:
            for key, content in members.items():
                new.writestr(key, content)
        return f"{kind.__name__} in {name}", out.getvalue()
    return kind.__name__, kind(blob, rng)
