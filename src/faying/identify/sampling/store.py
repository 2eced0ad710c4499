"""What a prediction or an identification keeps on disk: the bases, and every chunk of samples as it is done."""

from faying.reduction.reduce import Reduction
from faying.reduction.reduced import ReducedModel
from faying.study.part_folder import PartFile
from faying.sweeps.files import kept_model
from faying.sweeps.parallel import Rows
from faying.typing import Array

Bases = tuple[ReducedModel, tuple[Array, Array] | None]


class SampleStore(PartFile):
    """The folder OUT.part beside the output; without an output nothing is kept."""

    def model(self) -> Bases | None:
        """The bases that were kept, and what the test sees of them."""
        model, seen = kept_model(self.arrays("model")), self.arrays("seen")
        if model is None or seen is None:
            return None
        return model, (seen["basis"], seen["rigid"]) if "basis" in seen else None

    def keep(self, model: ReducedModel, seen: tuple[Array, Array] | None, reduction: Reduction) -> None:
        """Keep the bases: projected, and in full, so that they can grow on."""
        if self.folder is not None:
            self.keep_arrays("bases", reduction.arrays())
            self.keep_arrays("seen", {} if seen is None else {"basis": seen[0], "rigid": seen[1]})
            self.keep_arrays("model", model.arrays())

    def bases(self) -> dict[str, Array] | None:
        """The bases in full, for `Reduction.resumed`; None where they are missing or damaged."""
        return self.arrays("bases")

    def rows(self, what: str, number: int) -> Rows | None:
        """A chunk of samples that was kept; None where it is missing or damaged."""
        return self.arrays(f"{what}-{number:06d}")

    def keep_rows(self, what: str, number: int, rows: Rows) -> None:
        """Keep a chunk of samples."""
        plain = {name: values.astype(str) if name == "reasons" else values for name, values in rows.items()}
        self.keep_arrays(f"{what}-{number:06d}", plain)
