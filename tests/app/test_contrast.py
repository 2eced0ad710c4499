"""Colours of page and report against WCAG 2.2: 4.5:1 for text, 3:1 for the edges of fields (1.4.3 and 1.4.11, AA)."""

import re

import pytest

from faying.app.server import PAGE
from faying.output.page import STYLE

TEXT, EDGE = 4.5, 3.0
STYLES = {"page": (PAGE / "app.css").read_text(), "report": STYLE}
# what is written on what; a text that stands on a ground of its own is not on the others
GROUNDS = {
    "page": {
        "ink": ("back", "panel"),
        "soft": ("back", "panel"),
        "accent": ("back", "panel"),
        "bad": ("back", "panel", "bad-back"),
        "note": ("back", "panel"),
        "good": ("back", "panel"),
        "key": ("back",),
        "back": ("accent", "bad"),  # the first button, the number of a faulty line
    },
    "report": {"ink": ("back", "head", "flag"), "soft": ("back",), "accent": ("back",)},
}
CURVES = {f"c{k}": ("back",) for k in range(8)}
EDGES = {"page": {"edge": ("back", "panel"), **CURVES}, "report": {}}
NO_TEXT = {"line"}  # grounds that nothing is written on


def schemes(style):
    """Colours by name, light first, then dark, with those of the light one where dark has none, then print."""
    roots = [dict(re.findall(r"--([\w-]+):(#[0-9a-f]{3,6})", one)) for one in re.findall(r":root\{([^}]*)\}", style)]
    return [roots[0], *(roots[0] | one for one in roots[1:])]


def luminance(colour):
    """Relative luminance of sRGB, WCAG 2.2."""
    digits = colour[1:] if len(colour) == 7 else "".join(2 * one for one in colour[1:])
    parts = [int(digits[k : k + 2], 16) / 255 for k in (0, 2, 4)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    low, high = sorted((luminance(a), luminance(b)))
    return (high + 0.05) / (low + 0.05)


def test_the_formula_gives_its_known_values():
    assert contrast("#fff", "#000000") == pytest.approx(21.0)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.005)  # the known grey that just fails
    assert contrast("#767676", "#ffffff") == pytest.approx(4.54, abs=0.005)


@pytest.mark.parametrize("name", STYLES)
def test_every_text_can_be_read_on_every_ground(name):
    found = schemes(STYLES[name])
    assert len(found) >= 2
    for pairs, least in ((GROUNDS[name], TEXT), (EDGES[name], EDGE)):
        for colours in found:
            for text, grounds in pairs.items():
                for ground in grounds:
                    ratio = contrast(colours[text], colours[ground])
                    assert ratio >= least, f"--{text} on --{ground}: {colours[text]} on {colours[ground]}, {ratio:.2f}"


@pytest.mark.parametrize("name", STYLES)
def test_no_colour_is_left_out(name):
    style = STYLES[name]
    texts = set(re.findall(r"(?<![-\w])color:var\(--([\w-]+)\)", style))
    assert texts <= {*GROUNDS[name], *EDGES[name]}
    grounds = set(re.findall(r"background(?:-color)?:var\(--([\w-]+)\)", style))
    tested = {ground for every in GROUNDS[name].values() for ground in every}
    assert grounds <= tested | NO_TEXT
