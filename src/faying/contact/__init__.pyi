# The public names of faying.contact; __init__.py imports each when it is first used.
from . import asperity
from .compare import Comparison, compare, laws_of_surface
from .greenwood_williamson import GreenwoodWilliamson
from .half_space import HalfSpace
from .inputs import SurfaceInputs
from .jackson_streator import JacksonStreator
from .jk import JK
from .law import ContactLaw, Parameter, Response
from .majumdar_bhushan import MajumdarBhushan
from .morag_etsion import MoragEtsion
from .persson import Persson
from .power_law import PowerLaw
from .registry import find_law, laws
from .tabulated import TabulatedLaw
from .wang_komvopoulos import WangKomvopoulos
from .yan_komvopoulos import YanKomvopoulos

__all__ = [
    "JK",
    "Comparison",
    "ContactLaw",
    "GreenwoodWilliamson",
    "HalfSpace",
    "JacksonStreator",
    "MajumdarBhushan",
    "MoragEtsion",
    "Parameter",
    "Persson",
    "PowerLaw",
    "Response",
    "SurfaceInputs",
    "TabulatedLaw",
    "WangKomvopoulos",
    "YanKomvopoulos",
    "asperity",
    "compare",
    "find_law",
    "laws",
    "laws_of_surface",
]
