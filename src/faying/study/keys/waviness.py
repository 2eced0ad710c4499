"""[joint.form] waviness: random waves between the side of a scan and that of the face, their size said in one way."""

from typing import Any

from faying.contact.parameter import Parameter
from faying.form.waviness import GAUSSIAN, OF_WAVES, PARAMETERS, PROCESSES, RMS_OF_FLATNESS, Waviness
from faying.study.declaration.declared import Declared, Key
from faying.study.declaration.reader import Table
from faying.units import show

SIZES = {
    "Wq": PARAMETERS["waviness"],
    "Wa": Parameter("m", "mean absolute height of the waves of each face", 0),
    "flatness": Parameter("m", "flatness tolerance of each face, of which waves take a third", 0),
}
WAYS = (*SIZES, "process", "from")  # in which the size can be said


def read_waviness(table: Table) -> Waviness | None:
    """Read waviness = {...}; None where there is no size that can be used."""
    sizes, of_waves = ({name: table.get(name) for name in names} for names in (WAYS, OF_WAVES))
    stated = [way for way in WAYS if way in table.data]
    if len(stated) != 1:
        table.faults.add(
            f"{table.where} has {'no size' if not stated else 'sizes by ' + ' and '.join(stated)}; give one of "
            'Wq = "1 um", Wa = "0.8 um", flatness = "20 um", '
            f'process = "{next(iter(PROCESSES))}" (or {", ".join([*PROCESSES][1:])}), from = "scan"'
        )
        return None
    (way,) = stated
    if sizes[way] is None:
        return None
    values = {name: value for name, value in of_waves.items() if value is not None}
    return table.made(lambda: Waviness(**_size(way, sizes[way]), **values))


def _size(way: str, value: Any) -> dict[str, Any]:
    """The rms of each face [m] and where it comes from, for a size said in one way."""
    if way == "from":
        return {"Wq": None, "origin": "spectrum of the scan, continued to longer waves"}
    if way == "process":
        process = PROCESSES[value]
        ends = f"{show(process.least, 'm', digits=3)} to {show(process.greatest, 'm', digits=3)}"
        return {"Wq": GAUSSIAN * process.Wa, "origin": f"{value}, the geometric mean of Wa {ends}"}
    if way == "flatness":
        return {"Wq": RMS_OF_FLATNESS * value, "origin": f"a third of a flatness tolerance of {show(value, 'm')}"}
    return {"Wq": value if way == "Wq" else GAUSSIAN * value, "origin": f"{way} {show(value, 'm')}"}


WAVINESS: Declared = {
    **{name: Key.of_parameter(parameter) for name, parameter in SIZES.items()},
    "process": Key.text(
        "What made the faces; the size is the middle of the range of Wa that the process leaves.",
        None,
        tuple(PROCESSES),
    ),
    "from": Key.text("The size is that of the scan's spectrum, continued to longer waves.", None, ("scan",)),
    **{name: Key.of_parameter(parameter) for name, parameter in OF_WAVES.items()},
}
