"""What a prediction or an identification keeps on disk: the bases, and every chunk of samples as it is done."""

from collections.abc import Callable, Sequence

import numpy as np

from faying.reduction.reduce import Reduction
from faying.reduction.reduced import ReducedModel
from faying.study.part_folder import PartFile
from faying.sweeps.files import kept_model
from faying.sweeps.parallel import Rows, Work, each
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

    def all_rows(
        self, what: str, work: Work, chunks: Sequence[Sequence[int]], jobs: int, tell: Callable[[int, int], object]
    ) -> Rows:
        """Rows of all chunks of samples, one chunk behind the other; those that were kept are not evaluated again.

        tell: called with the samples done, and their number.
        """
        kept = {number: self.rows(what, number) for number in range(len(chunks))}
        found = {number: rows for number, rows in kept.items() if rows is not None}
        done, total = sum(len(chunks[number]) for number in found), sum(map(len, chunks))
        tell(done, total)
        left = {chunk[0]: number for number, chunk in enumerate(chunks) if number not in found}
        for chunk, rows in each(work, [chunks[number] for number in left.values()], jobs):
            found[left[chunk[0]]] = rows
            self.keep_rows(what, left[chunk[0]], rows)
            done += len(chunk)
            tell(done, total)
        return {name: np.concatenate([found[k][name] for k in range(len(chunks))]) for name in found[0]}

    def keep_rows(self, what: str, number: int, rows: Rows) -> None:
        """Keep a chunk of samples."""
        plain = {name: values.astype(str) if name == "reasons" else values for name, values in rows.items()}
        self.keep_arrays(f"{what}-{number:06d}", plain)
