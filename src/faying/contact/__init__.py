"""Contact laws: pressure in; real area, stiffness and loss out."""
