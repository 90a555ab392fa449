"""Options of the regions around a lumen."""

from collections.abc import Sequence
from typing import Annotated, TypedDict

from ._option import Option


class DomainOptions(TypedDict, total=False):
    """Regions around the lumen"""

    wall: Annotated[
        float | str | None,
        Option("Thickness of the vessel wall: a length (0.05, '5um'), a share of the radius ('0.2r'), a sum ('5um+0.1r'), or an array of the network"),
    ]
    wall_layers: Annotated[int, Option("Number of layers of the vessel wall", 2)]
    wall_growth: Annotated[float, Option("Thickness of each layer of the wall over that of the one before it, outwards", 1)]
    annulus: Annotated[
        float | str | None, Option("Perivascular space around the wall: its thickness, and after a colon its number of layers")
    ]
    shells: Annotated[
        Sequence[str] | None, Option("Further shells, each as 'NAME=THICKNESS[:LAYERS]', from the inside outwards", flag="shell")
    ]
    tissue: Annotated[
        str | None, Option("Tissue around the vessels: 'box', 'hull', 'box:MARGIN', 'hull:MARGIN', or the file of a closed surface")
    ]
    tissue_size: Annotated[float | None, Option("Maximum edge length in the tissue")]
    tissue_growth: Annotated[
        float, Option("Maximum ratio of edge lengths in adjacent layers of tetrahedra, away from the vessels", 1.3)
    ]
    embed: Annotated[
        bool, Option("Embed the vessels in the tissue as lines instead of meshing them; ``embedding`` of the mesh lists their pieces", False)
    ]
    embed_size: Annotated[
        float | str, Option("Edge length at embedded vessels: a length (0.05, '5um'), a multiple of the radius ('2r'), a sum, or an array of the network", "2r")
    ]
    tissue_remesh: Annotated[bool, Option("Remesh the surfaces of tissue and regions to the size of the tissue")]
    tissue_ends: Annotated[
        str, Option("Where vessels end that leave the surface around the tissue: 'surface' (it is opened there), 'inside', or 'refuse' such networks", "surface")
    ]
    tissue_tolerance: Annotated[float | None, Option("Maximum distance between a surface and the remeshed one")]
    tissue_regions: Annotated[
        Sequence[str] | None, Option("Regions of the tissue, each as 'NAME=SURFACE' with a closed surface", flag="tissue-region")
    ]
    without: Annotated[Sequence[str] | None, Option("Regions to leave out of the result, for example ['lumen']")]
