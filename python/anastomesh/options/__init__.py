"""Types of the keyword arguments, one ``TypedDict`` for each function.

A wrapper takes and hands on all keywords of ``anastomesh.mesh`` with ``**options: Unpack[MeshOptions]``.
"""

from .common import StrPath
from .verbs import (
    CheckOptions,
    CheckSurfaceOptions,
    ConvertOptions,
    GenerateOptions,
    MeshOptions,
    NetworkFlowOptions,
    NetworkOptions,
    PrepareOptions,
    RefineOptions,
    RenderOptions,
    SurfaceOptions,
    TetrahedralizeOptions,
    ViewOptions,
)

__all__ = [
    "CheckOptions",
    "CheckSurfaceOptions",
    "ConvertOptions",
    "GenerateOptions",
    "MeshOptions",
    "NetworkFlowOptions",
    "NetworkOptions",
    "PrepareOptions",
    "RefineOptions",
    "RenderOptions",
    "StrPath",
    "SurfaceOptions",
    "TetrahedralizeOptions",
    "ViewOptions",
]
