"""The program inside an FMU of a superelement. It runs where the FMU is imported, with NumPy alone.

Between two steps the forces stay as they were set last; for such forces the answer of each mode is exact.
"""

from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
from pythonfmu import Fmi2Causality, Fmi2Slave, Real

UNITS = {
    "force": ("N", "N m"),
    "displacement": ("m", "rad"),
    "velocity": ("m/s", "rad/s"),
    "acceleration": ("m/s^2", "rad/s^2"),
}  # along an axis, about one


class SuperelementUnit(Fmi2Slave):  # type: ignore[misc]  # the package has no types
    """Modes of a superelement: forces on its interfaces in, their motions out, from rest.

    `modes.npz` beside it holds names and words of the unknowns (k,), shapes (k, m) of modes of mass 1, their angular
    frequencies [rad/s], 0 of rigid motions, and damping ratios [-] (m,).
    """

    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        with np.load(Path(self.resources) / "modes.npz") as held:
            names, words = held["names"].tolist(), held["words"].tolist()
            self.shapes, self.omega, self.ratio = held["shapes"], held["omega"], held["ratio"]
            self.description = str(held["title"])
        self.force = np.zeros(len(names))
        self.x, self.v = np.zeros((2, len(self.omega)))
        outputs = {"displacement": lambda: self.x, "velocity": lambda: self.v, "acceleration": self._acceleration}
        for k, (name, word) in enumerate(zip(names, words, strict=True)):
            place, direction = name.rsplit(".", 1)
            for what, units in UNITS.items():
                of_modes = outputs.get(what)
                real = Real(
                    f"{place}.{what}.{direction}",
                    causality=Fmi2Causality.output if of_modes else Fmi2Causality.input,
                    description=f"{what} {word} [{units[direction.startswith('r')]}]",
                )
                if of_modes:
                    real.getter = lambda k=k, of_modes=of_modes: self.shapes[k] @ of_modes()
                else:
                    real.getter = lambda k=k: self.force[k]
                    real.setter = lambda value, k=k: self.force.__setitem__(k, value)
                self.register_variable(real, nested=False)

    def to_xml(self, *options: Any) -> Any:
        """The model's description, with the unknowns at the start that FMI 2.0 asks for."""
        root = super().to_xml(*options)
        structure = root.find("ModelStructure")
        first = deepcopy(structure.find("Outputs"))
        first.tag = "InitialUnknowns"
        structure.append(first)
        return root

    def _acceleration(self) -> Any:
        return self.force @ self.shapes - 2 * self.ratio * self.omega * self.v - self.omega**2 * self.x

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Go on by a step [s] under the forces that are set."""
        h, omega, decay = step_size, self.omega, self.ratio * self.omega
        swinging = omega * np.sqrt(1 - self.ratio**2)
        c = np.exp(-decay * h) * np.cos(swinging * h)
        s = np.exp(-decay * h) * h * np.sinc(swinging * h / np.pi)  # sin(w h) / w, h for w = 0
        load, elastic = self.force @ self.shapes, omega > 0
        still = np.divide(1 - c - decay * s, omega**2, out=np.full(len(omega), h**2 / 2), where=elastic)
        x, v = self.x, self.v
        self.x = c * x + s * (v + decay * x) + still * load
        self.v = c * v - s * (omega**2 * x + decay * v) + s * load
        return True
