"""Options of inlets, outlets and the one-dimensional flow estimate."""

from typing import Annotated, Literal, TypedDict

from ._option import Option
from .common import StrPath


class FlowOptions(TypedDict, total=False):
    """Inlets, outlets and flow"""

    outlets: Annotated[
        Literal["separate", "grouped", "by-order"],
        Option("Patches of outlets: one each, one for all, or one for each diameter-defined Strahler order", "separate"),
    ]
    extend_outlets: Annotated[float | None, Option("Length of the straight extension at each outlet, in its radii")]
    extend_inlets: Annotated[float | None, Option("Length of the straight extension at each inlet, in its radii")]
    inflow: Annotated[
        float | StrPath | None,
        Option(
            "Volume per second into each inlet, in the mesh's unit of length, or the CSV file of one period: times, then flows "
            "for all inlets or a column for each; if absent, the flow at Reynolds number 1"
        ),
    ]
    inlet_profile: Annotated[
        Literal["uniform", "parabolic", "womersley"] | None,
        Option("Velocity profile on inlets; if absent, that of the solver for a flow rate"),
    ]
    periods: Annotated[int, Option("Number of periods of pulsatile flow", 3)]
    outputs: Annotated[int, Option("Number of results per period of pulsatile flow", 20)]
    ramp: Annotated[
        float | None, Option("Seconds of the start from rest to pulsatile flow; if absent, a tenth of a period")
    ]
    outlet_model: Annotated[
        Literal["pressure", "resistance", "rcr", "structured-tree"], Option("Model beyond each outlet", "pressure")
    ]
    outlet_pressure: Annotated[float, Option("Pressure beyond the outlets", 0)]
    total_resistance: Annotated[float | None, Option("Resistance of all outlets in parallel, pressure per flow")]
    mean_pressure: Annotated[
        float | None, Option("Pressure at the inlets at mean flow; resistances take what the network leaves of it")
    ]
    outlet_split: Annotated[
        Literal["network", "murray"] | None,
        Option("Distribution of the resistance: by the network's flows, or by a power of the radius; if absent, network"),
    ]
    murray_exponent: Annotated[float | None, Option("Exponent of the radius for the split 'murray'; if absent, 3")]
    outlet_time_constant: Annotated[float | None, Option("Seconds: distal resistance times capacitance of 'rcr'")]
    proximal_fraction: Annotated[float | None, Option("Proximal part of the resistance of 'rcr'; if absent, 0.09")]
    tree_minimum_radius: Annotated[float | None, Option("Radius at which the vessels of 'structured-tree' end")]
    tree_stiffness: Annotated[
        float | None, Option("Stiffness E h / r of the vessels of 'structured-tree', as a pressure; if absent, rigid")
    ]
    viscosity: Annotated[
        float, Option("Dynamic viscosity in units that fit the mesh; the default is blood in SI units (Pa s)", 0.0035)
    ]
    density: Annotated[
        float, Option("Mass per volume in units that fit the mesh; the default is blood in SI units (kg/m³)", 1060)
    ]
