"""Folder ``mesh-complete`` of a SimVascular model, for svMultiPhysics.

In SimVascular's Python::

    from anastomesh.adapters import simvascular

    modeler = sv.modeling.Modeler(sv.modeling.Kernel.POLYDATA)
    model = modeler.read("aorta.vtp")
    simvascular.mesh_complete(model.get_polydata(), "mesh-complete", walls=[1], inlets=[2], size=0.2)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from .._arrays import Floats
from .._mesh import Mesh, Patch
from .._surface_verbs import tetrahedralize
from ..options import StrPath, TetrahedralizeOptions
from ._vtk import cell_array, triangles_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: Number of the patch ``wall``.
_WALL = 1


def mesh_complete(
    model: vtkPolyData,
    folder: StrPath,
    *,
    walls: Sequence[int],
    inlets: Sequence[int],
    face_ids: str = "ModelFaceID",
    **options: Unpack[TetrahedralizeOptions],
) -> Mesh:
    """Fills a closed model and writes the folder ``mesh-complete`` with ``solver.xml``.

    ``walls`` and ``inlets`` are face ids, values of the cell array ``face_ids``. All walls become the patch ``wall``. Inlets are
    named ``inlet``, ``inlet_1``, … in the given order, all other faces ``outlet_0``, ``outlet_1``, … in the order of their ids.
    """
    ids = cell_array(model, face_ids)
    if ids is None:
        raise ValueError(f"the model has no cell array {face_ids!r}: compute the faces of the model first")
    present = np.unique(ids).tolist()
    missing = [face for face in [*walls, *inlets] if face not in present]
    if missing:
        raise ValueError(f"the model has no face {missing[0]}: its faces are {', '.join(map(str, present))}")
    outlets = [face for face in present if face not in {*walls, *inlets}]
    caps = [("inlet" if i == 0 else f"inlet_{i}", face) for i, face in enumerate(inlets)]
    caps += [(f"outlet_{i}", face) for i, face in enumerate(outlets)]
    points, triangles = triangles_of(model)
    markers = np.full(len(ids), _WALL)
    patches = [Patch(_WALL, "wall")]
    for number, (name, face) in enumerate(caps, start=_WALL + 1):
        markers[ids == face] = number
        patches.append(_cap(number, name, points[triangles[ids == face]]))
    mesh = tetrahedralize(points, triangles, markers=markers, **options)
    mesh.patches = patches
    mesh.save(folder, format="simvascular")
    return mesh


def _cap(number: int, name: str, corners: Floats) -> Patch:
    """Patch of a flat face, whose triangles have the given corners."""
    vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    areas, normal = np.linalg.norm(vectors, axis=1), vectors.sum(axis=0)
    center = np.average(corners.mean(axis=1), axis=0, weights=areas)
    normal /= np.linalg.norm(normal)
    radius = np.sqrt(areas.sum() / np.pi)
    # The number stands for the node of a network.
    return Patch(number, name, number, tuple(center.tolist()), tuple(normal.tolist()), float(radius))
