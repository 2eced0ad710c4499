"""Studies at other preloads."""

from dataclasses import replace

from faying.joint.preload_case import PreloadCase


def pulled(study, *forces):
    """The study at these preloads [N], each the same in all bolts."""
    return replace(study, preloads=tuple(PreloadCase((float(force),) * len(study.bolts)) for force in forces))
