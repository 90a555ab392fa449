"""Options of one-dimensional flow and of models for other solvers."""

from typing import Annotated, Literal, TypedDict

from ._option import Option
from .common import StrPath


class ModelOptions(TypedDict, total=False):
    """Models and results"""

    vessels: Annotated[
        Literal["edges", "branches"],
        Option("Vessels of models and tables: each edge of the network, or each branch between bifurcations", "edges"),
    ]
    stiffness: Annotated[
        float | str | None,
        Option(
            "Stiffness E h / r of vessel walls as a pressure, or 'K1,K2,K3' for K1 exp(K2 r) + K3; "
            "if absent, vessels of steady models are rigid and others are arteries in SI units"
        ),
    ]
    result: Annotated[
        StrPath | None, Option("Result of a solver on the mesh of the network: an OpenFOAM case, or a .vtu file of svMultiPhysics")
    ]
    refine: Annotated[
        int | bool,
        Option("Move overlapping vessels apart first, as mesh does: True, or the maximum number of iterations", False),
    ]
