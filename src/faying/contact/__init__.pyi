# The public names of faying.contact; __init__.py imports each when it is first used.
from . import asperity
from .build import build, laws
from .compare import Comparison, compare
from .inputs import FractalSurface, RoughSurface, SurfaceInputs
from .law import ContactLaw, Response
from .models.cmy import CMY
from .models.greenwood_williamson import GreenwoodWilliamson
from .models.half_space import HalfSpace
from .models.jackson_streator import JacksonStreator
from .models.jk import JK
from .models.majumdar_bhushan import MajumdarBhushan
from .models.measured_heights import MeasuredHeights
from .models.mikic import Mikic
from .models.morag_etsion import MoragEtsion
from .models.persson import Persson
from .models.power_law import PowerLaw
from .models.tabulated import TabulatedLaw
from .models.wang_komvopoulos import WangKomvopoulos
from .models.yan_komvopoulos import YanKomvopoulos
from .parameter import Parameter

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
    "laws",
]
