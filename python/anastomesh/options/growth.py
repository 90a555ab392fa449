"""Options of synthetic networks."""

from typing import Annotated, Literal, TypedDict

from ._option import Option


class GrowthOptions(TypedDict, total=False):
    """Synthetic network"""

    organ: Annotated[
        Literal["kidney", "ellipsoid"], Option("Shape to fill: a rat's kidney, or an ellipsoid of even density", "kidney")
    ]
    seed: Annotated[int, Option("Seed of the random numbers; the same seed gives the same network", 0)]
    terminal_radius: Annotated[float | None, Option("Mean radius of terminals in µm; if absent, 10.08, or 4 with capillaries")]
    exponent: Annotated[
        float | None, Option("Exponent p of Murray's law r0^p = r1^p + r2^p; if absent, 3.2 for a kidney and 3 for an ellipsoid")
    ]
    size: Annotated[float | None, Option("Longest extent of the organ in µm; if absent, the terminal density of a rat's kidney")]
    capillaries: Annotated[
        bool, Option("Add veins and a capillary bed with loops, about 38 vessels per terminal; needs organ='ellipsoid'", False)
    ]
    capillary_radius: Annotated[float, Option("Mean radius of capillaries in µm", 1.75)]
    capillary_length: Annotated[float, Option("Mean length of capillaries in µm", 60)]
