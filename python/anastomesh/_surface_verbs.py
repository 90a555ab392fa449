"""Functions that fill surfaces with tetrahedra."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arrays
from ._arrays import Column, Rows
from ._foreign import is_surface, triangles_of
from ._mesh import Mesh
from ._progress import ProgressLike
from ._run import Done, work_folder
from ._surface import Surface, SurfaceLike
from ._verb import Verb
from .options import CheckSurfaceOptions, StrPath, TetrahedralizeOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack

_TETRAHEDRALIZE = Verb("tetrahedralize", TetrahedralizeOptions)

_CHECK_SURFACE = Verb("tetrahedralize", CheckSurfaceOptions, mode="--check-only")

#: A point in a region, its number, and optionally the maximum volume of its tetrahedra.
Region = tuple[Column, int] | tuple[Column, int, float]


@_TETRAHEDRALIZE.documents
def tetrahedralize(
    points: SurfaceLike | StrPath | Rows,
    triangles: Rows | None = None,
    *,
    markers: Column | None = None,
    segments: Rows | None = None,
    holes: Rows | None = None,
    regions: Sequence[Region] | None = None,
    progress: ProgressLike = None,
    **options: Unpack[TetrahedralizeOptions],
) -> Mesh:
    """Fills a closed surface with tetrahedra; every triangle stays a face of the mesh.

    The surface is given as two arrays, ``points`` (n, 3) and ``triangles`` (m, 3); or as one object: a :class:`Surface`, a
    ``pyvista.PolyData``, a ``trimesh.Trimesh``, or the path of a file (.off, .ply, .stl, .obj, .poly, .smesh, .node). Points
    without triangles become their Delaunay tetrahedralization. ``markers`` (m,) label the triangles.

    With ``plc=True``, ``segments`` (k, 2) are edges to keep, ``holes`` (h, 3) are points in parts that stay empty, and
    ``regions`` lists ``(point, number)`` or ``(point, number, max_volume)``.

    Raises :class:`InputError`, a ``ValueError``, if the surface is open, intersects itself or has another fault, and
    :class:`InvalidError` if a bound is not met, with the mesh in ``result``.
    """
    with work_folder() as folder:
        out = os.path.join(folder, "mesh.npyd")
        given = _Complex(points, triangles, markers, segments, holes, regions)
        done = given.run(_TETRAHEDRALIZE, out, options, progress, folder)
        return done.made(Mesh._read(out, done.report) if os.path.isdir(out) else None)


@_CHECK_SURFACE.documents
def check_surface(
    points: SurfaceLike | StrPath | Rows,
    triangles: Rows | None = None,
    *,
    markers: Column | None = None,
    segments: Rows | None = None,
    holes: Rows | None = None,
    regions: Sequence[Region] | None = None,
    progress: ProgressLike = None,
    **options: Unpack[CheckSurfaceOptions],
) -> dict[str, Any]:
    """Checks that a surface can be filled by :func:`tetrahedralize`, and returns the program's report.

    Raises :class:`InputError`, a ``ValueError``, if the surface is open, intersects itself or has another fault.
    """
    with work_folder() as folder:
        out = os.path.join(folder, "mesh.npyd")
        given = _Complex(points, triangles, markers, segments, holes, regions)
        return given.run(_CHECK_SURFACE, out, options, progress, folder).ensure_success().report or {}


class _Complex:
    """A surface with everything that belongs to it."""

    def __init__(
        self,
        points: SurfaceLike | StrPath | Rows,
        triangles: Rows | None,
        markers: Column | None,
        segments: Rows | None,
        holes: Rows | None,
        regions: Sequence[Region] | None,
    ) -> None:
        self._path: str | None = None
        self._beside = {"triangles": triangles, "markers": markers, "segments": segments, "holes": holes, "regions": regions}
        if isinstance(points, (str, os.PathLike)):
            self._path = os.fspath(points)
            for name, value in self._beside.items():
                if value is not None:
                    raise TypeError(f"{name}=: a file holds its own {name}: give it with arrays only")
        elif isinstance(points, Surface):
            self._points: Any = points.points
            self._beside["triangles"] = points.triangles
            if markers is None:
                self._beside["markers"] = points.markers
        elif triangles is None and is_surface(points):
            self._points, self._beside["triangles"] = triangles_of(points)
        else:
            self._points = points

    def run(self, verb: Verb, out: str, options: Mapping[str, object], progress: ProgressLike, folder: str) -> Done:
        return verb.run([self._path or self._write(folder), f"--output={out}"], options, progress, folder=folder)

    def _write(self, folder: str) -> str:
        points = _arrays.floats("points", self._points, 3)
        beside: dict[str, Any] = self._beside
        rows = ("points", len(points))
        triangles = _arrays.optional(_arrays.indices, "triangles", beside["triangles"], 3, *rows)
        count = 0 if triangles is None else len(triangles)
        path = os.path.join(folder, "surface.npyd")
        os.mkdir(path)
        _arrays.write(
            path,
            points=points,
            triangles=triangles,
            markers=_arrays.optional(_arrays.labels, "markers", beside["markers"], ("triangles", count)),
            segments=_arrays.optional(_arrays.indices, "segments", beside["segments"], 2, *rows),
            holes=_arrays.optional(_arrays.floats, "holes", beside["holes"], 3),
            regions=_arrays.optional(_regions, "regions", beside["regions"]),
        )
        return path


def _regions(name: str, regions: Sequence[Region]) -> _arrays.Floats:
    """Rows of x, y, z, number and maximum volume, which is 0 for no bound."""
    rows = []
    for row, region in enumerate(regions):
        if len(region) not in (2, 3) or np.shape(region[0]) != (3,):
            raise ValueError(f"{name}: row {row} is {region!r}: give (point, number) or (point, number, max_volume)")
        rows.append([*region[0], region[1], region[2] if len(region) == 3 else 0.0])
    return _arrays.floats(name, np.array(rows, dtype=np.float64).reshape(-1, 5), 5)
