"""Options of boundary layers."""

from collections.abc import Sequence
from typing import Annotated, TypedDict

from ._option import Option


class LayerOptions(TypedDict, total=False):
    """Boundary layers"""

    layers: Annotated[int | None, Option("Number of layers of thin tetrahedra along the wall")]
    layer_growth: Annotated[float, Option("Thickness of each layer over that of the one before it, from the wall", 2.5)]
    layer_thickness: Annotated[
        float,
        Option("Thickness of all layers as a share of the radius; for general surfaces, of half the local width", 0.12),
    ]


class PartialLayerOptions(TypedDict, total=False):
    """Boundary layers on parts of a surface"""

    layers_on: Annotated[
        Sequence[int | str] | None,
        Option("Markers or names of the parts with layers; they end in rings on flat parts without. All parts if absent", join=","),
    ]
    layers_in: Annotated[
        Sequence[int] | None,
        Option("Numbers of the regions with layers; facets between two have them on both sides. All regions if absent", join=","),
    ]
