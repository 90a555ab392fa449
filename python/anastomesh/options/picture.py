"""Options of pictures and HTML pages."""

from typing import Annotated, Literal, TypedDict

from ._option import Option
from .common import StrPath


class PictureOptions(TypedDict, total=False):
    """Picture"""

    size: Annotated[str | tuple[int, int], Option("Width and height in pixels", "1200x900", join="x")]
    view: Annotated[
        str | tuple[float, float],
        Option(
            "Viewpoint: 'auto' (across the two longest axes), 'front', 'back', 'left', 'right', 'top', 'bottom', "
            "or azimuth and elevation in degrees",
            "auto",
            join=",",
        ),
    ]
    zoom: Annotated[float, Option("Magnification; 1 fits everything into the picture", 1)]
    at: Annotated[str | tuple[float, float, float] | None, Option("Point at the centre of the picture", join=",")]
    color: Annotated[
        Literal["plain", "patch", "block", "radius", "order", "quality"] | None,
        Option("Quantity shown by colour; if absent, 'patch' for a mesh and 'radius' for a network"),
    ]
    data: Annotated[
        str | None, Option("Array of nodes or vessels of the network shown by colours, alone or with its unit: 'Pressure:Pa'")
    ]
    background: Annotated[Literal["light", "dark", "none"], Option("Background; 'none' is transparent", "light")]
    clip: Annotated[
        str | None,
        Option(
            "Plane in front of which tetrahedra are removed: 'x', 'y', 'z' or 'view', alone or with a place: 'x:12.5', 'view:40%'"
        ),
    ]
    cut_away: Annotated[str | None, Option("Plane at which the wall is cut open, in the form of clip")]
    samples: Annotated[int, Option("Samples per pixel and direction; more are smoother", 3)]


class FaultOptions(TypedDict, total=False):
    """Faults"""

    data: Annotated[
        str | None, Option("Array of nodes or vessels of the network shown by colours, alone or with its unit: 'Pressure:Pa'")
    ]
    memory: Annotated[
        str,
        Option(
            "Memory limit with its unit, as '500MB'. A VTU file that anastomesh has written is read block by block above it",
            "1GiB",
        ),
    ]
    check: Annotated[
        bool | None,
        Option(
            "Run the validity check and mark its faults; if absent, up to two million tetrahedra", flag="check", off="no-check"
        ),
    ]
    dump_dir: Annotated[StrPath | None, Option("Folder with the dumps of failed blocks")]
