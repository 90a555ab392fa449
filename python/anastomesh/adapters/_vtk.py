"""Surfaces and grids of vtk."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray, vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_TETRA, VTK_TRIANGLE, vtkCellArray, vtkDataSet, vtkPolyData, vtkUnstructuredGrid

from .._arrays import Floats, Ints
from .._mesh import Mesh

#: Surfaces of vtk: poly data, or a grid of triangles.
VtkSurface = vtkPolyData | vtkUnstructuredGrid


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


def surface_of(points: Floats, triangles: Ints, ids: Ints | None, name: str) -> vtkPolyData:
    """Poly data of triangles, with their ids as the cell array ``name``."""
    surface = vtkPolyData()
    surface.SetPoints(_points(points))
    surface.SetPolys(_cells(np.full(len(triangles), 3), triangles.ravel()))
    if ids is not None:
        add_cell_array(surface, name, numpy_to_vtkIdTypeArray(ids, deep=True))
    return surface


def grid_of(mesh: Mesh, ids: str, *, tets: bool = True, triangles: bool = True) -> vtkUnstructuredGrid:
    """A grid of the tetrahedra, then the boundary triangles; the cell array ``ids`` is 0 in tetrahedra, then the markers."""
    inside, boundary = mesh.tets[: None if tets else 0], mesh.triangles[: None if triangles else 0]
    markers = np.zeros(len(boundary), np.int64) if mesh.markers is None else mesh.markers[: len(boundary)]
    sizes = np.repeat([4, 3], [len(inside), len(boundary)])
    grid = vtkUnstructuredGrid()
    grid.SetPoints(_points(mesh.points))
    kinds = np.where(sizes == 4, VTK_TETRA, VTK_TRIANGLE).astype(np.uint8)
    grid.SetCells(numpy_to_vtk(kinds, deep=True), _cells(sizes, np.concatenate([inside.ravel(), boundary.ravel()])))
    of_cells = np.concatenate([np.zeros(len(inside), np.int64), markers.astype(np.int64)])
    add_cell_array(grid, ids, numpy_to_vtkIdTypeArray(of_cells, deep=True))
    return grid


def add_cell_array(data: vtkDataSet, name: str, array: vtkDataArray) -> None:
    """Adds an array with a value for each cell."""
    array.SetName(name)
    data.GetCellData().AddArray(array)


def _points(coordinates: Floats) -> vtkPoints:
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(coordinates), deep=True))
    return points


def _cells(sizes: Ints, corners: Ints) -> vtkCellArray:
    """Cells with the given numbers of points."""
    cells = vtkCellArray()
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    cells.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(corners.astype(np.int64), deep=True))
    return cells


def _numbers(array: object) -> Ints:
    numbers: Ints = np.asarray(vtk_to_numpy(array)).astype(np.int64)
    return numbers
