"""Options of the tetrahedralization of surfaces."""

from collections.abc import Sequence
from typing import Annotated, TypedDict

from ._option import Option
from .common import StrPath


class ComplexOptions(TypedDict, total=False):
    """Surface"""

    plc: Annotated[
        bool, Option("The input is a piecewise linear complex: facets may lie inside, dangle, and meet by threes", False)
    ]
    repair: Annotated[bool, Option("Orient triangles and merge points with equal coordinates first", False)]
    strict: Annotated[
        bool, Option("Fail on facets and segments outside the volume or in a hole, instead of leaving them out", False)
    ]
    tetgen: Annotated[str | None, Option("TetGen's switches instead of the other options, as 'pYq1.4a0.1'")]


class FillingOptions(TypedDict, total=False):
    """Tetrahedra"""

    refine: Annotated[bool, Option("Add points that improve the shape of tetrahedra", True, flag="", off="no-refine")]
    max_radius_edge: Annotated[
        float | None, Option("Maximum ratio of circumradius to shortest edge, where the boundary allows it")
    ]
    min_dihedral: Annotated[float | None, Option("Minimum dihedral angle in degrees, where the boundary allows it")]
    max_volume: Annotated[float | None, Option("Maximum volume of a tetrahedron; a mesh that exceeds it is an InvalidError")]
    size: Annotated[float | None, Option("Maximum edge length inside; if absent, any that the growth gives")]
    sizes_from: Annotated[
        StrPath | None, Option("Earlier mesh (.vtu) with maximum edge lengths; each place has that of the nearest point")
    ]
    array: Annotated[str | None, Option("Array of sizes_from: an edge length for each point or each cell")]
    growth: Annotated[float, Option("Growth of edge lengths per layer of tetrahedra, away from the surface; at least 1.1", 2)]
    uniform: Annotated[bool, Option("Fill the inside evenly with the mean edge length of the surface", False)]
    max_tets: Annotated[int, Option("Refuse meshes that would have more tetrahedra", 40_000_000)]
    region_size: Annotated[
        Sequence[str] | None, Option("Maximum edge length in regions, as '3=0.5' for region 3; one text for each region")
    ]
    region_growth: Annotated[
        Sequence[str] | None, Option("Growth in regions, below that of growth, as '3=1.5'; one text for each region")
    ]
    split: Annotated[bool, Option("Triangles of the input may be split, as TetGen does without Y", False)]
    remesh_surface: Annotated[
        bool | float | None,
        Option("Remesh the surface first, within this distance of the input; True: 0.001 of the diagonal of its box"),
    ]
