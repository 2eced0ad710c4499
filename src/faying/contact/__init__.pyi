# The public names of faying.contact; __init__.py imports each when it is first used.
from . import asperity
from .build import build, find_law, laws
from .cmy import CMY
from .compare import Comparison, compare
from .greenwood_williamson import GreenwoodWilliamson
from .half_space import HalfSpace
from .inputs import FractalSurface, RoughSurface, SurfaceInputs
from .jackson_streator import JacksonStreator
from .jk import JK
from .law import ContactLaw, Response
from .majumdar_bhushan import MajumdarBhushan
from .measured_heights import MeasuredHeights
from .mikic import Mikic
from .morag_etsion import MoragEtsion
from .parameter import Parameter
from .persson import Persson
from .power_law import PowerLaw
from .tabulated import TabulatedLaw
from .wang_komvopoulos import WangKomvopoulos
from .yan_komvopoulos import YanKomvopoulos

__all__ = [
    "CMY",
    "JK",
    "Comparison",
    "ContactLaw",
    "FractalSurface",
    "GreenwoodWilliamson",
    "HalfSpace",
    "JacksonStreator",
    "MajumdarBhushan",
    "MeasuredHeights",
    "Mikic",
    "MoragEtsion",
    "Parameter",
    "Persson",
    "PowerLaw",
    "Response",
    "RoughSurface",
    "SurfaceInputs",
    "TabulatedLaw",
    "WangKomvopoulos",
    "YanKomvopoulos",
    "asperity",
    "build",
    "compare",
    "find_law",
    "laws",
]
