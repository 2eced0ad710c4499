"""Keys of the numbers that may vary while the matrices of the parts stay: in a sweep, and where they scatter."""

from faying.contact.build import kinds
from faying.contact.parameter import FILE, TABLE, Parameter
from faying.form.form import VARIED
from faying.study.keys.joint import TANGENTIAL
from faying.study.keys.law import OF_SURFACE

# what may vary beside the entries of laws; parts by factors on their matrices, all else acts on the joints alone
OWN = {
    "surface.D": Parameter("", "fractal dimension", 2, 3),
    "surface.G": Parameter("m", "fractal roughness", 0),
    "surface.scan_area": Parameter("m^2", "area that the scan covers", 0),
    "bolt.preload": Parameter("N", "preload of the bolts", 0),
    "bolt.factor": Parameter("", "factor on the preload of the bolts", 0),
    "joint.friction": Parameter("", "coefficient of friction", 0, 10, "[)"),
    "joint.tangential": TANGENTIAL,
    "joint.stiffness": Parameter("", "factor on both stiffnesses of the joints", 0),
    "law.counterbody": Parameter("text", "what the rough face presses on", choices=("part", "rigid")),
}
OF_PART = {
    "stiffness": Parameter("", "factor on the stiffness of a part", 0),
    "mass": Parameter("", "factor on the mass of a part", 0),
}
MODEL = "law.model"
OF_ONE = {
    "bolt": ("preload", "factor"),
    "joint": ("friction", "stiffness", "tangential"),
}  # keys that one bolt or joint may have, by its name


def swept(key: str) -> Parameter | None:
    """What a sweep key declares, for any law that has it; None where there is no such key."""
    parts = key.split(".")
    if len(parts) == 3 and parts[-1] in OF_ONE.get(parts[0], ()):
        return OWN[f"{parts[0]}.{parts[-1]}"]
    if formed(parts):
        return VARIED.get(parts[-1])
    if parts[0] == "part":
        return OF_PART.get(parts[-1]) if len(parts) == 3 else None
    if key in OWN:
        return OWN[key]
    if parts[0] != "law" or len(parts) != 2 or parts[1] in OF_SURFACE:
        return None
    entries = [kind.law.entries().get(parts[1]) for kind in kinds().values()]
    return next((p for p in entries if p is not None and p.unit not in (FILE, TABLE)), None)


def formed(parts: list[str]) -> bool:
    """Whether a key is joint.form.SHAPE, or joint.NAME.form.SHAPE for one joint."""
    return parts[0] == "joint" and len(parts) in (3, 4) and parts[-2] == "form"
