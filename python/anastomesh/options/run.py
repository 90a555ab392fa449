"""Options of a meshing run."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal, TypedDict

from ._option import Option
from .common import StrPath


class RootOptions(TypedDict, total=False):
    """Inlets"""

    roots: Annotated[
        Sequence[Any] | None,
        Option(
            "Nodes that become inlets, by number or by their labels in the graph or file; "
            "if absent, the terminal of largest radius in each component",
            flag="root",
        ),
    ]


class WorkOptions(TypedDict, total=False):
    """Work directory"""

    work_dir: Annotated[
        StrPath | None, Option("Folder that keeps finished blocks, so that a run that was stopped can be resumed")
    ]
    restart: Annotated[
        bool, Option("Empty the work directory if it belongs to another network, other options or another version", False)
    ]
    make_missing: Annotated[bool, Option("Make blocks that shards have left undone instead of failing", False)]


class FidelityOptions(TypedDict, total=False):
    """Fidelity"""

    max_displacement: Annotated[
        float | None,
        Option(
            "Maximum distance of the axis from the given one, in radii; above it the result is an InvalidError; "
            "if absent, 1 for measured networks and no limit for others"
        ),
    ]
    allow_displaced: Annotated[bool, Option("Warn instead of failing when the axis exceeds max_displacement", False)]
    max_lumen_error: Annotated[
        float, Option("Maximum relative difference of the volume from that of the given lumen; above it: InvalidError", 0.1)
    ]
    allow_dropped: Annotated[
        bool,
        Option(
            "Warn instead of failing when repairs drop more than 2 radii of a vessel, or extend a tip by more than its length",
            False,
        ),
    ]


class RunOptions(TypedDict, total=False):
    """Run"""

    core: Annotated[
        float | None,
        Option(
            "Edge length on vessel axes over that at the wall, from 0.5 to 4; if absent, 1, or √stretch up to 2 without layers"
        ),
    ]
    joint: Annotated[
        Literal["disc", "woven", "none"],
        Option("Joints between blocks: flat discs, smoothed joints with the whole mesh in memory, or no cuts at all", "disc"),
    ]
    frozen_joints: Annotated[bool, Option("Skip smoothing of woven joints", False)]
    refined: Annotated[StrPath | None, Option("VTP file to which the refined network is written")]
    dump_dir: Annotated[StrPath | None, Option("Folder for the inputs of blocks that fail")]
    data: Annotated[
        str | Sequence[str] | None,
        Option(
            "Values to compute, found in Mesh.values: 'radius' and 'distance' at points; "
            "'branch', 'generation', 'strahler', 'node' and 'ratio' in cells",
            join=",",
        ),
    ]
