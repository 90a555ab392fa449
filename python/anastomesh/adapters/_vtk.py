"""Surfaces of vtk, filled with tetrahedra."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_TETRA, VTK_TRIANGLE, vtkCellArray, vtkDataSet, vtkPolyData, vtkUnstructuredGrid

from .._arrays import Array, Floats, Ints
from .._mesh import Mesh
from .._surface_verbs import tetrahedralize
from ..options import TetrahedralizeOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: Surfaces of vtk: poly data, or a grid of triangles.
VtkSurface = vtkPolyData | vtkUnstructuredGrid


def fill(surface: VtkSurface, ids: str, **options: Unpack[TetrahedralizeOptions]) -> Mesh:
    """Fills a closed surface; the cell array ``ids``, if the surface has it, becomes the markers of the triangles."""
    points, triangles = triangles_of(surface)
    return tetrahedralize(points, triangles, markers=cell_array(surface, ids), **options)


def triangles_of(surface: VtkSurface) -> tuple[Floats, Ints]:
    """Points and triangles of a surface."""
    cells = surface.GetPolys() if isinstance(surface, vtkPolyData) else surface.GetCells()
    sizes = np.diff(_numbers(cells.GetOffsetsArray()))
    if len(sizes) != surface.GetNumberOfCells() or (sizes != 3).any():
        raise ValueError("the surface has cells that are not triangles: triangulate it first")
    points = np.asarray(vtk_to_numpy(surface.GetPoints().GetData()), np.float64)
    return points, _numbers(cells.GetConnectivityArray()).reshape(-1, 3)


def cell_array(data: vtkDataSet, name: str) -> Ints | None:
    """Cell array of integers with a name, or None."""
    values = data.GetCellData().GetArray(name)
    return None if values is None else np.asarray(vtk_to_numpy(values)).astype(np.int64)


def point_array(data: vtkDataSet, name: str) -> Floats | None:
    """Point array with a name, or None."""
    values = data.GetPointData().GetArray(name)
    return None if values is None else np.asarray(vtk_to_numpy(values), np.float64)


def grid_of(mesh: Mesh, ids: str, *, tets: bool = True, triangles: bool = True) -> vtkUnstructuredGrid:
    """A grid of the tetrahedra, then the boundary triangles; the cell array ``ids`` is 0 in tetrahedra, then the markers."""
    inside, boundary = mesh.tets[: None if tets else 0], mesh.triangles[: None if triangles else 0]
    markers = np.zeros(len(boundary), np.int32) if mesh.markers is None else mesh.markers[: len(boundary)]
    sizes = np.repeat([4, 3], [len(inside), len(boundary)])
    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtkIdTypeArray(np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64), deep=True),
        numpy_to_vtkIdTypeArray(np.concatenate([inside.ravel(), boundary.ravel()]).astype(np.int64), deep=True),
    )
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(mesh.points), deep=True))
    grid = vtkUnstructuredGrid()
    grid.SetPoints(points)
    grid.SetCells(numpy_to_vtk(np.where(sizes == 4, VTK_TETRA, VTK_TRIANGLE).astype(np.uint8), deep=True), cells)
    add_cell_array(grid, ids, np.concatenate([np.zeros(len(inside), np.int32), markers.astype(np.int32)]))
    return grid


def add_cell_array(data: vtkDataSet, name: str, values: Array) -> None:
    """Adds an array with a value for each cell."""
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    data.GetCellData().AddArray(array)


def _numbers(array: object) -> Ints:
    numbers: Ints = np.asarray(vtk_to_numpy(array)).astype(np.int64)
    return numbers
