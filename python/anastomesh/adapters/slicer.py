"""Mesher for the CFD Mesh Generator of SlicerExtension-VMTK, with the names of its back end ``Netgen``.

In the Python console of 3D Slicer::

    from anastomesh.adapters import slicer as mesher
    from CfdMeshGeneratorLib import MeshingPipeline

    MeshingPipeline.Netgen = mesher
    mesh, surface = MeshingPipeline.MeshingPipeline().generateMesh(model.GetPolyData(), mesher="netgen", targetEdgeLength=1.0)
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

from .._arrays import Column, Floats, Ints, Rows
from .._binary import binary
from .._errors import Error
from .._mesh import Mesh
from .._surface_verbs import tetrahedralize as _tetrahedralize
from ._vtk import VtkSurface, cell_array, grid_of, triangles_of

#: Requirement that pip installs.
REQUIREMENT = "anastomesh"

#: Minimum of the option ``growth``.
_LEAST_GROWTH = 1.1


class TetrahedralizationError(RuntimeError):
    """The surface cannot be filled."""


class VolumeMeshing(Protocol):
    """Fields of the pipeline's ``VolumeMeshing`` that are read."""

    edgeLength: float
    netgenGrading: float


def isAvailable() -> bool:
    """True if the program is installed."""
    try:
        binary()
    except FileNotFoundError:
        return False
    return True


def tetrahedralize(
    vertices: Rows,
    faces: Rows,
    faceIds: Column,
    maxh: float,
    grading: float = 0.3,
    optimizationSteps: int = 3,
    sizingPoints: Rows | None = None,
    sizingLengths: Column | None = None,
) -> tuple[Floats, Ints, Ints, Ints]:
    """Fills a closed surface; returns points, tetrahedra, boundary triangles and the face id of each.

    Points and triangles of the surface come first and stay as they are. ``maxh`` is the maximum edge length inside, and
    ``grading`` the growth of edge lengths per length. Other arguments are ignored: tetrahedra are always improved, and edge
    lengths grow from those of the triangles.
    """
    mesh = _fill(vertices, faces, faceIds, maxh, grading)
    ids = np.zeros(len(mesh.triangles), np.int32) if mesh.markers is None else mesh.markers
    return mesh.points, mesh.tets, mesh.triangles, ids


def runAnastomesh(
    surfaceMesh: VtkSurface, cellEntityIdsArrayName: str, outputSurfaceElements: bool, volumeMeshing: VolumeMeshing
) -> vtkUnstructuredGrid:
    """Fills a closed surface with tetrahedra under entity id 0, followed by its triangles under their own ids.

    The arguments are those of the pipeline's ``runNetgen``.
    """
    points, triangles = triangles_of(surfaceMesh)
    ids = cell_array(surfaceMesh, cellEntityIdsArrayName)
    mesh = _fill(points, triangles, ids, volumeMeshing.edgeLength, volumeMeshing.netgenGrading)
    return grid_of(mesh, cellEntityIdsArrayName, triangles=outputSurfaceElements)


def _fill(points: Rows, triangles: Rows, ids: Column | None, size: float, grading: float) -> Mesh:
    try:
        # As a complex, a surface that faces inwards is turned.
        return _tetrahedralize(points, triangles, markers=ids, plc=True, size=size, growth=max(_LEAST_GROWTH, 1 + grading))
    except Error as error:
        raise TetrahedralizationError(str(error)) from error
