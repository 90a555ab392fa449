"""Options that say how a network is read."""

from typing import Annotated, TypedDict

from ._option import Option


class ReadingOptions(TypedDict, total=False):
    """Reading the network"""

    radius_array: Annotated[
        str | None, Option("Name of the array, column or attribute that holds the radius; found by its name if absent")
    ]
    radius: Annotated[float | None, Option("Radius of all vessels, for a file without radii")]
    diameters: Annotated[bool, Option("The file holds diameters instead of radii", False)]
    radius_scale: Annotated[
        float | None, Option("Factor for radii alone, for files whose radii have another unit than the positions")
    ]
    scale: Annotated[float | None, Option("Factor for positions and radii")]
    units: Annotated[
        str | None,
        Option(
            "Unit of length ('m', 'cm', 'mm' or 'um'), or two with a colon: 'um:m' reads micrometres and converts them to metres"
        ),
    ]
