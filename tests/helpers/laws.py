"""Contact laws given by their stiffness as a function of pressure."""

import numpy as np

from faying.contact.response import Response


class Given:
    """What a joint asks of a contact law, from functions of pressure: k_n, k_t [Pa/m], loss_n, loss_t [-]."""

    source, least_pressure, assumptions, memory = "this test", 0.0, (), None

    def __init__(self, name="given", greatest_pressure=1e9, **given):
        self.name, self.greatest_pressure, self.given = name, greatest_pressure, given

    def at_pressure(self, pressure):
        p = np.asarray(pressure, dtype=float)
        return Response(pressure=p, **{name: function(p) for name, function in self.given.items()})
