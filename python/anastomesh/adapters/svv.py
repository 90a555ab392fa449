"""Meshes of the trees and forests of svVascularize.

::

    from anastomesh.adapters import svv

    svv.mesh(tree, wall="0.2r").save("tree.vtu")
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .._arrays import Floats
from .._mesh import Mesh
from .._network import Network
from .._network_verbs import mesh as _mesh
from .._progress import ProgressLike
from ..options import MeshOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: Columns of a tree's ``data``: both ends and the radius of a vessel.
_ENDS_AND_RADIUS = [0, 1, 2, 3, 4, 5, 21]


def network(grown: Any) -> Network:
    """The network of a ``Tree``, or of all trees of a ``Forest`` with their connections; the roots of trees are its roots."""
    trees, connections = _parts(grown)
    vessels = np.concatenate([*trees, *connections])
    # Vessels that meet have bitwise equal ends.
    nodes, ends = np.unique(vessels[:, :6].reshape(-1, 3), axis=0, return_inverse=True)
    edges = ends.reshape(-1, 2)
    first = np.cumsum([0, *map(len, trees)])[:-1]
    return Network(nodes, edges, edge_radii=vessels[:, 6], roots=edges[first, 0])


def mesh(grown: Any, *, progress: ProgressLike = None, **options: Unpack[MeshOptions]) -> Mesh:
    """Meshes a ``Tree`` or a ``Forest``; the keyword arguments are those of :func:`anastomesh.mesh`."""
    return _mesh(network(grown), progress=progress, **options)


def _parts(grown: Any) -> tuple[list[Floats], list[Floats]]:
    """Vessels of trees, the root of each first, and vessels that connect trees."""
    if hasattr(grown, "data"):
        return [_vessels(grown)], []
    if grown.connections is None:
        return [_vessels(tree) for trees in grown.networks for tree in trees], []
    joined = grown.connections.tree_connections
    trees = [_vessels(tree) for connection in joined for tree in connection.connected_network]
    curves = [curve for connection in joined for of_tree in connection.vessels for curve in of_tree]
    return trees, [np.asarray(curve, np.float64)[:, :7] for curve in curves]


def _vessels(tree: Any) -> Floats:
    vessels: Floats = np.asarray(tree.data, np.float64)[:, _ENDS_AND_RADIUS]
    return vessels
