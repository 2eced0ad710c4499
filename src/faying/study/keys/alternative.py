"""[[alternative]]: another law, surface or form for every joint, whose modes are listed with those of the study."""

from dataclasses import dataclass

from faying.form.form import Form
from faying.study.declaration.declared import Declared, Inner, Key
from faying.study.declaration.reader import Table
from faying.study.keys.form import FORM, read_form
from faying.study.keys.law import LAW, LawChoice
from faying.study.keys.surface import SURFACE, SurfaceChoice

ALTERNATIVE: Declared = {
    "law": Inner(says="The law, with the keys of [law].", keys=LAW.keys, models=LAW.models),
    "surface": Inner(says="The surface, with the keys of [surface].", keys=SURFACE, either=True),
    "form": Inner(says="The form, with the keys of [joint.form].", keys=FORM),
    "name": Key.text("What tables call it; the label of its law where left out.", "auto"),
}


@dataclass(frozen=True, kw_only=True)
class AlternativeChoice:
    """A law, a surface and a form for all joints, in place of those of the study where they are given.

    name: what the tables call it.
    """

    name: str
    law: LawChoice | None = None
    surface: SurfaceChoice | None = None
    form: Form | None = None

    @classmethod
    def of(cls, table: Table, index: int) -> "AlternativeChoice":
        """Read one [[alternative]]."""
        law, surface = table.inner("law", LawChoice.of), table.inner("surface", SurfaceChoice.of)
        form = table.inner("form", read_form)
        if law is None and surface is None and form is None:
            table.faults.add(f"{table.where}: give a law, a surface or a form that differs from the study's")
        name = table.get("name", law.model if law is not None else f"alternative {index + 1}")
        return cls(name=name or "", law=law, surface=surface, form=form)
