"""Surfaces and networks of other packages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeGuard, Union

import numpy as np

from ._arrays import Array

if TYPE_CHECKING:
    import pyvista


class TrimeshLike(Protocol):
    """A ``trimesh.Trimesh``, or any object with its arrays."""

    @property
    def vertices(self) -> Any: ...
    @property
    def faces(self) -> Any: ...


class GraphLike(Protocol):
    """A graph of networkx."""

    @property
    def nodes(self) -> Any: ...
    @property
    def edges(self) -> Any: ...
    @property
    def adj(self) -> Any: ...


#: Surfaces of other packages.
ForeignSurface = Union["pyvista.PolyData", TrimeshLike]

#: Networks of other packages: a graph, or a PolyData with lines.
ForeignNetwork = Union["GraphLike", "pyvista.PolyData"]


def is_graph(thing: object) -> TypeGuard[GraphLike]:
    """True for a graph of networkx."""
    return all(hasattr(thing, name) for name in ("nodes", "edges", "adj"))


def has_lines(thing: object) -> TypeGuard[pyvista.PolyData]:
    """True for a PolyData with lines."""
    return bool(getattr(thing, "n_lines", 0)) and hasattr(thing, "save")


def is_surface(thing: object) -> TypeGuard[ForeignSurface]:
    """True for a surface of pyvista or trimesh."""
    return hasattr(thing, "faces") and (hasattr(thing, "points") or hasattr(thing, "vertices"))


def triangles_of(surface: Any) -> tuple[Any, Any]:
    """Points and triangles of a surface of pyvista or trimesh."""
    if hasattr(surface, "vertices"):
        return np.asarray(surface.vertices), np.asarray(surface.faces)
    if not hasattr(surface, "points") or not hasattr(surface, "faces"):
        raise TypeError(
            f"a surface is needed, not {type(surface).__name__}: points and triangles, a Surface, a pyvista.PolyData, "
            "a trimesh.Trimesh, or the path of a file"
        )
    if not getattr(surface, "is_all_triangles", True):
        raise ValueError("the PolyData has faces that are not triangles: call its triangulate() first")
    return np.asarray(surface.points), np.asarray(surface.faces).reshape(-1, 4)[:, 1:]


def polydata_of(points: Array, triangles: Array) -> pyvista.PolyData:
    """A ``pyvista.PolyData`` of triangles."""
    import pyvista

    # The annotations of pyvista reject float64 points with numpy 1; arrays of any dtype pass.
    surface: pyvista.PolyData = pyvista.PolyData.from_regular_faces(points, triangles.astype(int))
    return surface
