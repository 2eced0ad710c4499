# The public names of faying.contact; __init__.py imports each when it is first used.
from . import asperity
from .jk import JK
from .law import ContactLaw, Parameter, Response
from .registry import find_law, laws
