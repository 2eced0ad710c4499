"""All tables of a study."""

from faying.study.declaration.declared import Declared, Inner, Key
from faying.study.keys.alternative import ALTERNATIVE
from faying.study.keys.backbone import BACKBONE
from faying.study.keys.bolt import BOLT
from faying.study.keys.bolt_sheet import BOLT_SHEET
from faying.study.keys.dowel import DOWEL
from faying.study.keys.geometry import GEOMETRY
from faying.study.keys.joint import JOINT
from faying.study.keys.law import LAW
from faying.study.keys.load import LOAD
from faying.study.keys.material import MATERIALS, PARTS
from faying.study.keys.solution import MODES, RESPONSE, TIGHTENING
from faying.study.keys.support import MASS, SUPPORT
from faying.study.keys.surface import SURFACE
from faying.study.keys.test import TEST
from faying.study.keys.vibration import VIBRATION

STUDY: Declared = {
    "title": Key.text("What tables and report call the study.", "untitled"),
    "material": MATERIALS,
    "geometry": Inner(
        says="The parts: a STEP file to mesh, or a mesh file of another program.",
        keys=GEOMETRY,
        required=True,
        either=True,
    ),
    "part": PARTS,
    "joint": Inner(says="Two faces that meet; a part alone has none.", keys=JOINT, many=True),
    "law": LAW,
    "surface": Inner(
        says="The rough surface of all joints without one of their own: a scan, or D, G and scan_area.",
        keys=SURFACE,
        either=True,
    ),
    "alternative": Inner(
        says="Another law, surface or form for all joints, whose modes are listed with those of the study.",
        keys=ALTERNATIVE,
        many=True,
    ),
    "backbone": Inner(says="Frequency and damping of a mode against its amplitude.", keys=BACKBONE),
    "bolt": Inner(says="A bolt and what tightens it; joints that are not bonded need one.", keys=BOLT, many=True),
    "dowel": Inner(says="A pin in holes of several parts, which carries shear alone.", keys=DOWEL, many=True),
    "bolt_sheet": Inner(
        says="What the sheet of a bolt needs beyond the rest of the study.", keys=BOLT_SHEET, many=True
    ),
    "load": Inner(
        says="A load case on the preloaded structure, for `faying loads`. All that it gives acts together.",
        keys=LOAD,
        many=True,
    ),
    "vibration": Inner(
        says="What shakes the structure in service: random vibration, or a sine sweep.", keys=VIBRATION, many=True
    ),
    "support": Inner(says="A face that is held, at rest or on springs.", keys=SUPPORT, many=True),
    "mass": Inner(says="A mass that is fixed to a face or at a point.", keys=MASS, many=True),
    "modes": Inner(says="How many modes, and how they are computed.", keys=MODES),
    "tightening": Inner(says="Bolts that are tightened one after the other.", keys=TIGHTENING),
    "response": Inner(says="Frequency response at every preload.", keys=RESPONSE),
    "test": Inner(
        says="A hammer test to compare with the model: frequencies, or a file of modes or FRFs.", keys=TEST, either=True
    ),
    "uncertain": Inner(
        says=(
            "Numbers that scatter, each named as an axis of a sweep (at the end of this page), with a distribution "
            'such as "200 GPa +- 4 GPa" or "0.1 to 0.6".'
        ),
        free=True,
    ),
}
