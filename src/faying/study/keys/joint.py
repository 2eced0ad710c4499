"""[[joint]]: two faces that meet, with the form, surface and law of this joint alone."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

from faying.contact.auto import Choice
from faying.contact.parameter import Parameter
from faying.errors import InputError
from faying.form.form import VARIED, Form
from faying.joint.joint_law import JointLaw
from faying.materials import MOST_FRICTION
from faying.study.declaration.declared import NUMBER, Declared, Inner, Key, Put
from faying.study.declaration.reader import Table
from faying.study.keys.face import face_names, two_faces
from faying.study.keys.form import FORM, read_form
from faying.study.keys.law import LAW, LawChoice
from faying.study.keys.surface import SURFACE, SurfaceChoice

TANGENTIAL = Parameter("", "tangential over normal stiffness, k_t/k_n", 0, 2, "(]")


def _tangential(value: Any, name: str) -> Any:
    """ "law", "mindlin", or k_t/k_n as a number."""
    if value in ("law", "mindlin"):
        return value
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not 0 < value <= TANGENTIAL.greatest:
        raise InputError(
            f'{name} = {value!r} should be "law", "mindlin", or k_t/k_n, above 0 and at most 2; for example 0.4'
        )
    return float(value)


@dataclass(frozen=True, kw_only=True)
class JointChoice:
    """Two faces that meet, before there is a mesh to place them on.

    search_distance [m] between faces that count as meeting; surface and law: of this joint alone, those of the study
    where None; form: the distance of the faces before any load, roughness apart; bonded: whether the faces are
    welded or glued, which takes nothing else; number: its place among the [[joint]] of the study, from 1; stiffness: a
    factor on both stiffnesses of its law [-], which sweeps and scatter vary.
    """

    name: str
    faces: tuple[str, str]
    springs: Literal["per-area", "per-node"] = "per-area"
    tangential: Literal["law", "mindlin"] | float | None = None
    friction: float | None = None
    search_distance: float | None = None
    surface: SurfaceChoice | None = None
    law: LawChoice | None = None
    form: Form | None = None
    bonded: bool = False
    state: Literal["first", "settled"] = "first"
    number: int = 0
    stiffness: float = 1.0

    def laid(self, choice: Choice, nu: float, made: Callable[[JointLaw], JointLaw] | None = None) -> JointLaw:
        """Lay a contact law on this joint.

        Args:
            choice: the law, and why it was taken.
            nu: Poisson's ratio of the rough face [-].
            made: returns a law that equals its argument and may have its tables already; the argument where None.
        """
        law = JointLaw(model=choice.law, tangential=self.tangential, nu=nu, reason=choice.reason, mates=choice.mates)
        law = law if made is None else made(law)
        return law if self.stiffness == 1 else law.scaled(self.stiffness)

    @classmethod
    def of(cls, table: Table, index: int) -> "JointChoice":
        """Read one [[joint]]."""
        name = table.get("name", f"joint {index + 1}")
        bonded = table.get("bonded")
        more = [key for key in table.data if key not in ("name", "faces", "bonded")]
        if bonded and more:
            table.faults.add(
                f"{table.where}.{more[0]}: joint {name!r} is bonded, so that it has no pressure, slip or law; leave "
                f"{', '.join(more)} out, or bonded"
            )
        return cls(
            name=name,
            faces=face_names(table, name),
            **{key: table.get(key) for key in ("springs", "tangential", "friction", "search_distance", "state")},
            surface=table.inner("surface", SurfaceChoice.of),
            law=table.inner("law", LawChoice.of),
            form=table.inner("form", read_form),
            bonded=bonded,
            number=index + 1,
        )


def read_joints(top: Table) -> tuple[tuple[JointChoice, ...], tuple[JointChoice, ...]]:
    """Take all [[joint]]: those that bolts press together, and those that are bonded."""
    every = [JointChoice.of(table, index) for index, table in enumerate(top.tables("joint"))]
    joints, bonds = (tuple(joint for joint in every if joint.bonded is bonded) for bonded in (False, True))
    if bonds:
        top.faults.note_alike("joints", [joint.name for joint in every])
    return joints, bonds


JOINT: Declared = {
    "surface": Inner(says="A surface for this joint alone, with the keys of [surface].", keys=SURFACE, either=True),
    "law": Inner(says="A law for this joint alone, with the keys of [law].", keys=LAW.keys, models=LAW.models),
    "name": Key.text("What tables call it.", "joint 1"),
    "bonded": Key.truth(
        "The faces are welded or glued: their nodes are one. The joint has no pressure and no "
        "law, and takes no other key but name and faces."
    ),
    "faces": two_faces("The two faces; the first is the rough one."),
    "springs": Key.text(
        "Springs per area on both faces, or one at each pair of nodes, as in the JK paper; the latter depends on the "
        "mesh.",
        "per-area",
        ("per-area", "per-node"),
    ),
    "friction": Key.within(
        0,
        MOST_FRICTION,
        "Coefficient at which the joint slips while the bolts are tightened, and in a backbone; sticks everywhere "
        "where left out.",
    ).varying(short="friction"),
    "tangential": Key(
        '"law", "mindlin", or k_t/k_n, above 0 and at most 2',
        {"anyOf": [NUMBER, {"enum": ["law", "mindlin"]}]},
        'Tangential stiffness: "law" takes that of the law, "mindlin" takes k_t/k_n = 2(1 - nu)/(2 - nu), and a '
        "number is k_t/k_n itself; measured ratios reach from 0.1 to 0.7. That of the law where it has one, else "
        "Mindlin's, if left out.",
        read=_tangential,
        parameter=TANGENTIAL,
    ).varying(),
    "search_distance": Key.quantity("m", "Largest distance of two faces that still make a joint."),
    "state": Key.text(
        'What the joint has carried before: nothing, "first"; or the greatest preload of the study, "settled", so that '
        "it unloads and loads again along one elastic curve. The same for all joints.",
        "first",
        ("first", "settled"),
    ),
    "form": Inner(says="Form of the two faces together, as a gap. What is given adds up.", keys=FORM),
}


def _in_form(name: str) -> Put:
    return lambda joint, value: replace(joint, form=(joint.form or Form()).with_value(name, value))


# where the numbers of a form stand under [joint], and what [uncertain] calls them, where it is not their own name
_PLACES = {"waviness": "form.waviness.Wq", "waviness_seed": "form.waviness.seed"}
_SHORT = {"flatness": "flatness", "waviness": "waviness"}
# numbers that vary and that no key of [[joint]] holds by their name
JOINT_NUMBERS: Declared = {
    "stiffness": Key.of_parameter(Parameter("", "factor on both stiffnesses of the joints", 0)).varying(
        short="stiffness"
    ),
    **{
        f"form.{name}": Key.of_parameter(parameter).varying(
            _in_form(name), place=_PLACES.get(name, ""), short=_SHORT.get(name, "")
        )
        for name, parameter in VARIED.items()
    },
}
