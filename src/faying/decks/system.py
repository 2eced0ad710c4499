"""The unit system of a model: a length and a force; seconds always; the rest follows."""

from dataclasses import dataclass

from faying import units


@dataclass(frozen=True)
class UnitSystem:
    """Units of a deck, such as mm and N, from which MPa, tonne and N s/mm follow."""

    length: str
    force: str = "N"

    @property
    def metre(self) -> float:
        """How many of the length one metre is [-]."""
        return 1 / units.scale(self.length, "m", name="unit of length")

    @property
    def newton(self) -> float:
        """How many of the force one newton is [-]."""
        return 1 / units.scale(self.force, "N", name="unit of force")

    @property
    def stiffness(self) -> float:
        """Factor from N/m; the same from N s/m."""
        return self.newton / self.metre

    @property
    def pressure(self) -> float:
        """Factor from Pa."""
        return self.newton / self.metre**2

    @property
    def density(self) -> float:
        """Factor from Pa/m, a stiffness per area."""
        return self.newton / self.metre**3

    @property
    def mass(self) -> float:
        """Factor from kg."""
        return self.newton / self.metre

    def describe(self) -> str:
        """One line for a deck."""
        mass = {("mm", "N"): " (tonne)", ("m", "N"): " (kg)"}.get((self.length, self.force), "")
        return (
            f"units: {self.length}, {self.force}, s; mass {self.force} s2/{self.length}{mass}; stiffness {self.force}/"
            f"{self.length}; stress {self.force}/{self.length}2"
        )
