"""One asperity pressed by a rigid plane: force, area, mean pressure, stiffness and energy of its interference.

One file per published model. Names are imported when they are first used; `models()` lists the models.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
