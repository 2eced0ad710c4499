"""Texts of figures: units with their signs, symbols with their subscripts, keys of a study in words.

Files, terminals and study files keep plain letters ("um", "k_n", `bolt.preload`); a figure shows what a journal prints.
"""

import re

_UNITS = (
    (re.compile(r"(?<![A-Za-z])um(?![A-Za-z])"), "µm"),
    (re.compile(r"(?<![A-Za-z])uN(?![A-Za-z])"), "µN"),
    (re.compile(r"(?<![A-Za-z])(m|mm|nm|µm|s|kg|N)\^?([23])(?![0-9A-Za-z.])"), None),
    (re.compile(r"(?<![A-Za-z])[Oo]hm(?![A-Za-z])"), "Ω"),
    (re.compile(r"(?<=[A-Za-z²³)])\*(?=[A-Za-z(])"), "·"),
)
_SYMBOL = re.compile(r"(?<![\w$\\{])([A-Za-z])_([A-Za-z0-9]{1,5})(?![\w}])")
_POWERS = {"2": "²", "3": "³"}

# the last word of a key, or its first and last, in words
_WORDS = {
    "bolt.preload": "preload",
    "bolt.factor": "factor on the preload",
    "joint.stiffness": "factor on the stiffness",
    "joint.tangential": r"$k_\mathrm{t}/k_\mathrm{n}$",
    "joint.friction": "friction",
    "law.model": "contact law",
    "law.factor": "factor on the law",
    "part.E": "factor on Young's modulus",
    "part.density": "factor on the density",
    "surface.G": "fractal roughness $G$",
    "surface.D": "fractal dimension $D$",
    "surface.fitted_G": "fractal roughness $G$, fitted",
    "surface.fitted_D": "fractal dimension $D$, fitted",
    "E": "Young's modulus",
    "nu": "Poisson's ratio",
    "k_t/k_n": r"$k_\mathrm{t}/k_\mathrm{n}$",
}


def unit(text: str) -> str:
    """Return a unit as a journal prints it: "m/(N*s^2)" is "m/(N·s²)", "um" is "µm"."""
    for pattern, sign in _UNITS:
        text = pattern.sub(sign or (lambda found: found[1] + _POWERS[found[2]]), text)
    return text


def typeset(text: str) -> str:
    """Return a text of Faying for a figure: symbols such as k_n with a subscript, units with their signs.

    Dollar signs of the text stand as they are. Names that users give go through `faying.style.plain` instead.
    """
    return unit(_SYMBOL.sub(r"$\1_\\mathrm{\2}$", text))


def name_of(key: str) -> str:
    """Return what a figure calls a key of a study: `bolt.left.preload` is "preload, left"."""
    first, *middle = key.split(".")
    last = middle.pop() if middle else ""
    if not last:
        return typeset(first).replace("_", " ") if "$" not in typeset(first) else typeset(first)
    owner = ".".join(word for word in middle if word != "form").strip('"').replace("$", r"\$")
    words = _WORDS.get(f"{first}.{last}") or _WORDS.get(last) or typeset(last)
    return f"{words.replace('_', ' ') if '$' not in words else words}{', ' + owner if owner else ''}"
