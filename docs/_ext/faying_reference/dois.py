"""Every `doi:10...` in a text as a link."""

import re

from docutils import nodes
from sphinx.transforms.post_transforms import SphinxPostTransform

DOI = re.compile(r"doi:\s?(10\.\d{4,}/[^\s,;\"']*[^\s,;.\"':])")


class LinkDois(SphinxPostTransform):
    """Put a link in place of the text."""

    default_priority = 900

    def run(self, **_: object) -> None:
        """Go through all texts that are not code or links already."""
        for text in list(self.document.findall(nodes.Text)):
            inside = (nodes.reference, nodes.literal, nodes.literal_block, nodes.title)
            if "doi:" not in text or any(isinstance(one, inside) for one in _parents(text)):
                continue
            text.parent.replace(text, _linked(str(text)))


def _parents(node: nodes.Node) -> list[nodes.Node]:
    found: list[nodes.Node] = []
    while (node := node.parent) is not None:
        found.append(node)
    return found


def _linked(text: str) -> list[nodes.Node]:
    out: list[nodes.Node] = []
    end = 0
    for found in DOI.finditer(text):
        name = found[1]
        if name.endswith(")") and name.count(")") > name.count("("):
            name = name[:-1]
        out.append(nodes.Text(text[end : found.start()]))
        out.append(nodes.reference("", f"doi:{name}", refuri=f"https://doi.org/{name}", internal=False))
        end = found.start(1) + len(name)
    return [*out, nodes.Text(text[end:])]
