"""Options of the refinement that moves overlapping vessels apart."""

from collections.abc import Sequence
from typing import Annotated, Literal, TypedDict

from ._option import Option
from .common import StrPath


class IterationOptions(TypedDict, total=False):
    """Iterations"""

    iterations: Annotated[int, Option("Maximum number of iterations", 200)]
    every: Annotated[int, Option("Iterations between two rows of metrics; 0 measures at both ends only", 10)]
    metrics: Annotated[StrPath | None, Option("CSV file to which the metrics are written")]
    plot: Annotated[StrPath | None, Option("SVG file with plots of the metrics")]


class RefinementOptions(TypedDict, total=False):
    """Refinement of the network"""

    barrier_rate: Annotated[float, Option("Rate of the barrier force, which moves overlapping vessels apart", 25)]
    repel_rate: Annotated[float, Option("Rate of the repelling force, which lengthens short vessels", 0.3)]
    angle_rate: Annotated[float, Option("Rate of the angle force, which opens narrow angles", 0.02)]
    clearance: Annotated[float, Option("Target distance between the axes of two vessels, in sums of their radii", 1.2)]
    max_move: Annotated[
        float | None,
        Option(
            "Maximum displacement of a node, in its radii; float('inf') sets no limit. If absent, chosen from the kind of network"
        ),
    ]
    free_terminals: Annotated[float, Option("Maximum displacement of terminals and roots, in the network's unit of length", 0)]
    crowded_terminals: Annotated[
        Literal["keep", "part", "merge"],
        Option(
            "Treatment of terminals closer to each other than the sum of their radii: list them, move them apart, or merge them",
            "part",
        ),
    ]
    residual: Annotated[
        Literal["report", "shrink", "fuse"],
        Option(
            "Treatment of overlaps that remain: list them, shrink radii by up to 30 %, or mesh both vessels as one lumen",
            "shrink",
        ),
    ]
    hold: Annotated[
        str | Sequence[str],
        Option(
            "Metrics that must not become worse than in the input; if no state meets this, nothing is moved",
            "overlaps,far-pairs",
            join=",",
        ),
    ]
