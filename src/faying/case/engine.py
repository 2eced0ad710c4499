"""The engine of a case."""

from faying.case.case import Case
from faying.joint.modal import Engine as Engine
from faying.joint.state import engine_for


def engine_of(name: str, case: Case) -> Engine:
    """The engine of a name. Raises InputError for another name than `ENGINES` has."""
    return engine_for(name, case.modal, case.study.preloads)
