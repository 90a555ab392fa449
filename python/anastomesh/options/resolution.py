"""Options of the size of elements in the mesh of a network."""

from typing import Annotated, TypedDict

from ._option import Option
from .common import StrPath


class ResolutionOptions(TypedDict, total=False):
    """Resolution"""

    rho: Annotated[float, Option("Voxels across the thinnest vessel of a cluster, at least 2.5; larger is finer", 3)]
    follow: Annotated[
        float,
        Option("How far edge lengths follow the radius of wider vessels: 1 in proportion, 0 as fine as the thinnest vessel", 1),
    ]
    stretch: Annotated[float, Option("Length over width of tetrahedra along tubes, from 1 to 20", 1)]
    size_at: Annotated[
        float | str | None,
        Option("Factor for edge lengths at forks, from 0.25 to 1; or the name of an array on the network's nodes"),
    ]
    sizes_from: Annotated[
        StrPath | None, Option("Earlier mesh (.vtu) with edge lengths: edges are shorter where it has less than the resolution")
    ]
    array: Annotated[str | None, Option("Array of sizes_from: an edge length for each point or each cell")]
    memory: Annotated[str | None, Option("Memory limit with its unit, as '500MB'; 2GiB if absent")]
    refine: Annotated[
        int | bool,
        Option("Move overlapping vessels apart before meshing: True, or the maximum number of iterations", False),
    ]
    keep_going: Annotated[bool, Option("Leave out blocks that fail; the result is then in a StageError", False)]
