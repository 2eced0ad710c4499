"""A mesh of named parts with named faces: solid elements of any kind, nodes in metres."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from faying.fe.bonded import bonded_mesh
from faying.fe.figure import mesh_axes
from faying.fe.solids import SolidMesh
from faying.misuse import checked_call

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@checked_call
@dataclass(frozen=True, kw_only=True, repr=False)
class Mesh(SolidMesh):
    """Nodes, the solid elements of each part, and the faces of elements that make up each named face.

    No node is shared by two parts: parts meet through joints alone, unless they are bonded.

    Args:
        points: Nodes (n, 3) [m].
        parts: Name -> blocks of elements, one array (e, a) of nodes for each kind; a tells the kind: tet4, wedge6,
            hex8, tet10, wedge15, hex20. Nodes are in VTK's order. A single array stands for one block.
        faces: Name -> blocks of element faces (f, a): tri3, quad4, tri6, quad8, normals out of the part.
        face_part: Name of a face -> name of its part.
        source: File that the mesh came from.
        node_numbers: Numbers (n,) of the nodes in that file; 1, 2, ... where None.
        turned: Whether each node's displacements are in directions of its own in the file (n,); None where none are.
        bonded: Pairs of parts that are one body, where they are welded or glued: they share nodes, or are tied.
        ties: Pairs of faces that are welded or glued and whose nodes do not match.
        notes: What the reader of the file left out.

    Raises:
        InputError: Empty parts, elements of negative volume, nodes of no element, coordinates that are not numbers.
    """

    @checked_call
    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the parts, with the largest named faces in colours of their own.

        Args:
            ax: Matplotlib axes with three dimensions to draw into; new ones where None.

        Returns:
            The axes.
        """
        return mesh_axes(self, ax)

    @checked_call
    def bonded_at(self, *pairs: tuple[str, str]) -> "Mesh":
        """Return the mesh with faces welded or glued, and their parts one body.

        Nodes of both faces become one where they match; else the faces are `ties`.

        Args:
            pairs: Names of two faces each, on two parts.

        Returns:
            The mesh; `bodies` are its parts that hang together.

        Raises:
            InputError: A face does not exist, both are on one part, or they do not meet.
        """
        return bonded_mesh(self, [(f"{first} on {second}", (first, second)) for first, second in pairs])
