"""Formats of Anastomesh for meshio. Importing this module registers them.

The command ``meshio`` with these formats::

    python -m anastomesh.adapters.meshio convert tree.swc tree.vtu
"""

from __future__ import annotations

import os
import sys
from typing import Any

import meshio
import numpy as np
from meshio._cli import main

from .._files import is_folder_of_arrays
from .._mesh import Mesh, Patch
from .._network import Network
from .._surface import Surface

#: Tetrahedra and triangles that are written, by their order.
_KINDS = {1: ("tetra", "triangle"), 2: ("tetra10", "triangle6")}

#: Names of the cell array with the patch of a triangle: those of this program, Gmsh and Medit.
_PATCHES = ("patch", "gmsh:physical", "medit:ref")

#: Names of arrays of radii.
_RADII = ("radius", "Radius", "MaximumInscribedSphereRadius")


def read(path: str) -> meshio.Mesh:
    """Reads a mesh, or the network in a folder of arrays."""
    if is_folder_of_arrays(path) and os.path.exists(os.path.join(path, "nodes.npy")):
        return read_network(path)
    return Mesh.load(path).to_meshio()


def read_network(path: str) -> meshio.Mesh:
    """Reads a network as lines with the array ``radius`` at points or cells."""
    network = Network.load(path)
    return meshio.Mesh(
        network.nodes,
        [("line", network.edges)],
        point_data={} if network.radii is None else {"radius": network.radii},
        cell_data={} if network.edge_radii is None else {"radius": [network.edge_radii]},
    )


def write(path: str, mesh: meshio.Mesh, **_: Any) -> None:
    """Writes a mesh in the format of its extension."""
    from_meshio(mesh).save(path)


def from_meshio(mesh: meshio.Mesh) -> Mesh | Surface | Network:
    """A mesh if there are tetrahedra, else a surface if there are triangles, else a network of the lines."""
    cells = mesh.cells_dict
    tetra, triangle = _KINDS[2 if "tetra10" in cells else 1]
    others = sorted(set(cells) - {tetra, triangle, "line", "vertex"})
    if others:
        beside = " beside tetra10" if "tetra10" in cells else ""
        raise ValueError(f"cells of type {others[0]} cannot be written{beside}: use line, {tetra}, {triangle}")
    triangles, markers = cells.get(triangle), _cell_data(mesh, _PATCHES, triangle)
    if tetra in cells:
        patches = [Patch(int(id), name) for name, (id, dimension) in mesh.field_data.items() if dimension == 2]
        boundary = np.zeros((0, 3), np.int32) if triangles is None else triangles
        return Mesh(mesh.points, cells[tetra], boundary, markers, patches=patches)
    if triangles is not None:
        return Surface(mesh.points, triangles, markers)
    if "line" not in cells:
        raise ValueError("the mesh has no cells")
    radii = next((mesh.point_data[name] for name in _RADII if name in mesh.point_data), None)
    return Network(mesh.points, cells["line"], radii, _cell_data(mesh, _RADII, "line"))


def _cell_data(mesh: meshio.Mesh, names: tuple[str, ...], kind: str) -> Any:
    """First array of the names that cells of a kind have, or None."""
    found = (mesh.cell_data_dict.get(name, {}).get(kind) for name in names)
    return next((values for values in found if values is not None), None)


meshio.register_format("anastomesh", [".npyd", ".pvtu", ".foam", ".svmesh", ".msh2", ".glb", ".3mf"], read, {"anastomesh": write})
meshio.register_format(
    "anastomesh-network",
    [".swc", ".vtp", ".am", ".graphml", ".gxl", ".net", ".pajek", ".paj", ".vmv", ".edge"],
    read_network,
    {"anastomesh-network": write},
)

if __name__ == "__main__":
    sys.exit(main())
