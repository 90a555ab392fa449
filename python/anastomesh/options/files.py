"""Options of files that are written."""

from typing import Annotated, Literal, TypedDict

from ._option import Option


class CapOptions(TypedDict, total=False):
    """Caps"""

    no_caps: Annotated[bool, Option("Leave the inlets and outlets of a boundary open, without caps", False)]


class RegionFileOptions(TypedDict, total=False):
    """Files of regions"""

    split_regions: Annotated[
        bool, Option("Write each region to a file beside the output, too, with the ids of the whole mesh", False)
    ]


class FileOptions(TypedDict, total=False):
    """File"""

    format: Annotated[
        Literal["vtu", "pvtu", "msh", "msh2", "medit", "openfoam", "simvascular", "npy", "tetgen"] | None,
        Option("Format of a mesh; found by the extension if absent"),
    ]
    prisms: Annotated[
        bool,
        Option(
            "Write the prisms and pyramids of layers as whole cells, with the array 'layer' (VTU and PVTU), or without (MSH)",
            False,
        ),
    ]
    parts: Annotated[
        int | None,
        Option("Number of balanced parts for parallel solvers: processor folders (.foam), or parts with ghost cells (.pvtu, .msh)"),
    ]
    float32: Annotated[
        bool, Option("Round coordinates in VTU and PVTU files to 32 bits; the validity check holds for the exact ones", False)
    ]
    cells: Annotated[
        Literal["all", "tets"],
        Option("Cells in VTU and PVTU files; with 'tets' the boundary goes to a file NAME_boundary.vtp beside it", "all"),
    ]
    compress: Annotated[Literal["zlib", "none"], Option("Compression of arrays in VTU and PVTU files", "zlib")]
