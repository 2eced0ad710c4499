# The public names of faying.contact.asperity; __init__.py imports each when it is first used.
from .base import AsperityModel, AsperityResponse, models
from .chang_etsion_bogy import ChangEtsionBogy
from .ghaednia import Ghaednia
from .hertz import Hertz
from .jackson_green import JacksonGreen
from .jk import JK
from .kogut_etsion import KogutEtsion
from .lin_lin import LinLin
from .unloading import Brake, EtsionKligermanKadin, load_index
from .zhao_maietta_chang import ZhaoMaiettaChang

__all__ = [
    "JK",
    "AsperityModel",
    "AsperityResponse",
    "Brake",
    "ChangEtsionBogy",
    "EtsionKligermanKadin",
    "Ghaednia",
    "Hertz",
    "JacksonGreen",
    "KogutEtsion",
    "LinLin",
    "ZhaoMaiettaChang",
    "load_index",
    "models",
]
