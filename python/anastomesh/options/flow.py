"""Options of inlets, outlets and the one-dimensional flow estimate."""

from typing import Annotated, Literal, TypedDict

from ._option import Option


class FlowOptions(TypedDict, total=False):
    """Inlets, outlets and flow"""

    outlets: Annotated[
        Literal["separate", "grouped", "by-order"],
        Option("Patches of outlets: one each, one for all, or one for each diameter-defined Strahler order", "separate"),
    ]
    extend_outlets: Annotated[float | None, Option("Length of the straight extension at each outlet, in its radii")]
    extend_inlets: Annotated[float | None, Option("Length of the straight extension at each inlet, in its radii")]
    inflow: Annotated[
        float | None,
        Option("Volume per time into each inlet, in the mesh's unit of length; if absent, the flow at Reynolds number 1"),
    ]
    viscosity: Annotated[
        float, Option("Dynamic viscosity in units that fit the mesh; the default is blood in SI units (Pa s)", 0.0035)
    ]
    density: Annotated[
        float, Option("Mass per volume in units that fit the mesh; the default is blood in SI units (kg/m³)", 1060)
    ]
