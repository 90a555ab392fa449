"""Triangulated surfaces."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from . import _arrays, _files, _ply
from ._arrays import Column, Rows
from ._foreign import ForeignSurface, polydata_of, triangles_of
from .options import ConvertOptions, StrPath

if TYPE_CHECKING:
    import pyvista
    from typing_extensions import Unpack


class Surface:
    """Triangulated surface: triangle ``i`` has the corners ``points[triangles[i]]``, counter-clockwise from outside."""

    def __init__(
        self, points: Rows, triangles: Rows, markers: Column | None = None, *, report: dict[str, Any] | None = None
    ) -> None:
        self.points = _arrays.floats("points", points, 3)
        self.triangles = _arrays.indices("triangles", triangles, 3, "points", len(self.points))
        #: Patch of each triangle (1 is the wall), or None.
        self.markers = _arrays.optional(_arrays.labels, "markers", markers, ("triangles", len(self.triangles)))
        #: The program's report of the run; empty without one.
        self.report = report or {}

    def __repr__(self) -> str:
        return f"Surface({len(self.points):,} points, {len(self.triangles):,} triangles)"

    @classmethod
    def of(cls, surface: SurfaceLike) -> Surface:
        """The surface itself, or one made from an object of pyvista or trimesh."""
        return surface if isinstance(surface, cls) else cls(*triangles_of(surface))

    def to_pyvista(self) -> pyvista.PolyData:
        """The surface as a ``pyvista.PolyData``, with the cell array ``patch`` if there are markers."""
        surface = polydata_of(self.points, self.triangles)
        if self.markers is not None:
            surface.cell_data["patch"] = self.markers
        return surface

    def save(self, path: StrPath, **options: Unpack[ConvertOptions]) -> None:
        """Writes a .stl, .ply, .obj, .off, .glb, .3mf or .vtp file; the keyword arguments are those of ``convert``."""
        if os.fspath(path).endswith(".ply") and not options:
            # The program reads PLY files without their patches.
            _ply.write(os.fspath(path), self.points, self.triangles, self.markers)
        else:
            _files.save(self, path, options)

    @classmethod
    def load(cls, path: StrPath) -> Surface:
        """Reads a surface, or the boundary of a mesh, in any format that the program reads."""
        return _files.load(path, "surface.ply", cls._read)

    def _write(self, folder: str) -> str:
        """Writes it for the program and returns the path."""
        path = os.path.join(folder, "surface.ply")
        _ply.write(path, self.points, self.triangles, self.markers)
        return path

    @classmethod
    def _read(cls, path: str, report: dict[str, Any] | None = None) -> Surface:
        """Reads a PLY file that the program has written."""
        return cls(*_ply.read(path), report=report)


#: Surfaces that functions accept, beside two arrays and the path of a file.
SurfaceLike = Surface | ForeignSurface
