"""Options of the repair of measured networks."""

from typing import Annotated, Literal, TypedDict

from ._option import Option


class PreparationOptions(TypedDict, total=False):
    """Preparation of the network"""

    as_is: Annotated[bool, Option("Skip all repairs and take the network as given", False)]
    keep_radii: Annotated[bool, Option("Keep outlying radii, and refuse zero or missing ones", False)]
    keep_doubles: Annotated[bool, Option("Keep duplicate lines that run side by side", False)]
    keep_spurs: Annotated[bool, Option("Keep spurs", False)]
    keep_joints: Annotated[bool, Option("Keep branch points that share one lumen, and the loops between them", False)]
    keep_points: Annotated[bool, Option("Keep the points of polylines instead of resampling them", False)]
    smooth_noise: Annotated[bool, Option("Smooth points closer than half a radius, within half of both tolerances", False)]
    keep_short_tips: Annotated[
        bool, Option("Keep terminals so close to a branch point that their cap lies inside another vessel", False)
    ]
    touching: Annotated[
        Literal["join", "retract", "keep"],
        Option(
            "Treatment of terminals that end in or on another vessel: join them, shorten them until the cap is clear, or keep",
            "retract",
        ),
    ]
    drop_islands: Annotated[int, Option("Drop connected components with fewer nodes than this", 0)]
    axis_tolerance: Annotated[float, Option("Maximum distance of a resampled axis from the given one, in radii", 0.05)]
    radius_tolerance: Annotated[float, Option("Maximum relative change of a resampled radius", 0.02)]
