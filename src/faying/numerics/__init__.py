"""Factorisations, eigenvalues and small bases of large matrices; no joint is known here."""
