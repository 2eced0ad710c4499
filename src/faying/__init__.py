"""Faying: from a measured rough surface and a bolt preload to the modes of the bolted structure."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__version__ = "0.1.0"
