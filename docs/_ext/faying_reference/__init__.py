"""The reference of the site, made from the code: public names, commands, study keys, result variables, laws."""

from sphinx.application import Sphinx

from faying_reference import api, commands, docstrings, dois, law_pages, rst, tables, validation

DIRECTIVES = {
    "cells": rst.Cells,
    "public-names": api.PublicNames,
    "contact-names": api.ContactNames,
    "commands": commands.Commands,
    "study-keys": tables.StudyKeys,
    "result-variables": tables.ResultVariables,
    "sweep-axes": tables.Axes,
    "estimators": tables.Estimators,
    "programs": tables.Programs,
    "catalogue": tables.Catalogue,
    "law-table": tables.LawTable,
    "notes": tables.Notes,
    "validation": validation.Validation,
    "law-facts": law_pages.Facts,
    "law-parameters": law_pages.Parameters,
    "law-ratios": law_pages.Ratios,
}


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directives."""
    for name, directive in DIRECTIVES.items():
        app.add_directive(name, directive)
    app.add_post_transform(dois.LinkDois)
    app.connect("builder-inited", law_pages.write)
    app.connect("autodoc-process-docstring", docstrings.process)
    app.connect("autodoc-process-signature", api.signature)
    app.connect("missing-reference", api.resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
