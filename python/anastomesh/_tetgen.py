"""Drop-in replacement for the class ``TetGen`` of PyPI's ``tetgen``."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._arrays import Array, Column, Floats, Ints, Rows
from ._foreign import ForeignSurface, is_surface, polydata_of, triangles_of
from ._mesh import Mesh
from ._progress import ProgressLike
from ._surface_verbs import tetrahedralize as _tetrahedralize
from .options import StrPath
from .options.tetgen import IgnoredOptions, TetGenOptions

if TYPE_CHECKING:
    import pyvista
    from typing_extensions import Unpack

#: Keywords that ask for another result: their only accepted value, and the reason.
_REFUSED: dict[str, tuple[Any, str]] = {
    "psc": (False, "curved surfaces are not supported"),
    "refine": (False, "a mesh cannot be refined: mesh its surface again with tighter bounds"),
    "cdt": (False, "the boundary is split (nobisect=False) or kept (nobisect=True)"),
    "coarsen": (False, "coarsening is not supported"),
    "weighted": (False, "weights are not supported"),
    "metric": (False, "background meshes are not supported: give maxvolume, or add_region with max_vol"),
    "insertaddpoints": (False, "lists of added points are not supported: give them as points of the surface"),
    "convex": (False, "the convex hull is not filled: give the points alone to anastomesh.tetrahedralize"),
    "voroout": (False, "Voronoi diagrams are not written"),
    "bgmesh": (None, "background meshes are not supported: give maxvolume, or add_region with max_vol"),
    "bgmeshfilename": ("", "background meshes are not supported: give maxvolume, or add_region with max_vol"),
    "coarsen_percent": (1.0, "coarsening is not supported"),
    "metric_scale": (1.0, "background meshes are not supported"),
    "elem_growth_ratio": (0.0, "background meshes are not supported"),
}


class TetGen:
    """A surface to be filled: ``TetGen(polydata)``, ``TetGen(points, triangles)`` or ``TetGen(path)``."""

    def __init__(self, arg0: ForeignSurface | StrPath | Rows, arg1: Rows | None = None, arg2: Column | None = None) -> None:
        self._markers = arg2
        self._holes: list[Sequence[float]] = []
        self._regions: list[tuple[Sequence[float], int, float]] = []
        self._repairs = False
        self._all_edges = self._all_faces = False
        self._made: Mesh | None = None
        points: Any = arg0
        triangles: Any = arg1
        if isinstance(arg0, (str, os.PathLike)):
            import pyvista

            points = pyvista.read(os.fspath(arg0))
        if triangles is None:
            if not is_surface(points):
                raise TypeError("a surface is needed: a PolyData, points and triangles, or the path of a file")
            if not getattr(points, "is_all_triangles", True):
                raise RuntimeError("Invalid mesh. Must be an all triangular mesh.")
            points, triangles = triangles_of(points)
        self.v: Floats = np.asarray(points, dtype=np.float64)
        self.f: Ints = np.asarray(triangles)

    def add_hole(self, point_in_hole: Sequence[float]) -> None:
        """Keeps the part of space around a point empty."""
        self._holes.append(point_in_hole)

    def add_region(self, id: int, point_in_region: Sequence[float], max_vol: float = 0.0) -> None:
        """Gives a number, and optionally a maximum volume, to the part of space around a point."""
        self._regions.append((point_in_region, id, max_vol))

    def make_manifold(self, verbose: bool = False) -> None:
        """Orients triangles and merges equal points when the surface is filled. It repairs nothing else."""
        self._repairs = True

    def tetrahedralize(
        self,
        plc: bool = True,
        *,
        quality: bool = True,
        nobisect: bool = False,
        minratio: float = 2.0,
        mindihedral: float = 0.0,
        maxvolume: float = -1.0,
        fixedvolume: bool = False,
        varvolume: bool = False,
        regionattrib: bool = False,
        edgesout: bool = False,
        facesout: bool = False,
        order: int = 1,
        switches: str = "",
        progress: ProgressLike = None,
        **others: Unpack[TetGenOptions],
    ) -> tuple[Floats, Ints, Floats, Ints]:
        """Fills the surface; returns points, tetrahedra, regions of tetrahedra (with ``regionattrib``) and markers of faces.

        Keywords that tune algorithms of TetGen are ignored. Keywords that ask for another result raise ``NotImplementedError``.
        ``switches`` are TetGen's and replace all keywords.
        """
        _refuse(others, order)
        if not switches:
            switches = "p" if plc else ""
            switches += f"q{minratio:.17g}/{mindihedral:.17g}" if quality else ""
            switches += "Y" if nobisect else ""
            switches += f"a{maxvolume:.17g}" if maxvolume > 0 else ""
            switches += "a" if varvolume or fixedvolume and maxvolume <= 0 else ""
            switches += "A" if regionattrib else ""
        self._all_edges, self._all_faces = edgesout or "e" in switches, facesout or "f" in switches
        self._made = _tetrahedralize(
            self.v,
            self.f,
            markers=self._markers,
            holes=self._holes or None,
            regions=self._regions or None,
            repair=self._repairs,
            tetgen=switches,
            progress=progress,
        )
        return self.node, self.elem, self.attributes, self.triface_markers

    @property
    def is_tetrahedralized(self) -> bool:
        """True if there is a mesh."""
        return self._made is not None

    @property
    def _mesh(self) -> Mesh:
        if self._made is None:
            raise AttributeError("there is no mesh yet: call tetrahedralize() first")
        return self._made

    @property
    def node(self) -> Floats:
        """Points (n, 3): those of the surface in their order, then added ones."""
        return self._mesh.points

    @property
    def elem(self) -> Ints:
        """Tetrahedra (m, 4)."""
        return self._mesh.tets

    @property
    def attributes(self) -> Floats:
        """Region of each tetrahedron (m, 1); empty without ``regionattrib``."""
        regions = self._mesh.regions
        asked = regions is not None and bool(np.any(regions != 0))
        return np.asarray(regions, dtype=np.float64).reshape(-1, 1) if asked else np.zeros((0, 0))

    @property
    def trifaces(self) -> Ints:
        """Triangles of the boundary (k, 3), with ``facesout`` those of all tetrahedra."""
        return _faces(self.elem, 3) if self._all_faces else self._mesh.triangles

    @property
    def triface_markers(self) -> Ints:
        """Markers of the triangles of the boundary (k,), with ``facesout`` 0 for those inside."""
        markers = self._mesh.markers
        known = np.zeros(len(self._mesh.triangles), np.int32) if markers is None else markers
        if not self._all_faces:
            return known
        by_face = dict(zip(map(tuple, np.sort(self._mesh.triangles, axis=1).tolist()), known.tolist(), strict=False))
        return np.array([by_face.get(tuple(face), 0) for face in self.trifaces.tolist()], np.int32)

    @property
    def edges(self) -> Ints:
        """Edges of the boundary (e, 2), with ``edgesout`` those of all tetrahedra."""
        return _faces(self.elem if self._all_edges else self._mesh.triangles, 2)

    @property
    def grid(self) -> pyvista.UnstructuredGrid:
        """The tetrahedra as a ``pyvista.UnstructuredGrid``."""
        import pyvista

        grid = pyvista.UnstructuredGrid({pyvista.CellType.TETRA: self.elem}, self.node)
        if len(self.attributes):
            grid.cell_data["regions"] = self.attributes[:, 0]
        return grid

    @property
    def mesh(self) -> pyvista.PolyData:
        """The surface as a ``pyvista.PolyData``."""
        return polydata_of(self.v, self.f)

    def plot(self, **options: Any) -> Any:
        """Plots the mesh with pyvista, which gets the keyword arguments."""
        return self.grid.plot(**options)

    def write(self, filename: StrPath, binary: bool = True) -> None:
        """Writes a .vtk or .vtu file with pyvista."""
        self.grid.save(os.fspath(filename), binary=binary)


def _refuse(others: Mapping[str, Any], order: int) -> None:
    """Raises an exception for keywords that are unknown or ask for another result."""
    if order != 1:
        raise NotImplementedError(f"order={order} is not supported: use order=1, or anastomesh.tetrahedralize(order=2)")
    for name, value in others.items():
        if name in _REFUSED:
            usual, instead = _REFUSED[name]
            if value is not usual and value != usual:
                shown = repr(value) if isinstance(value, (bool, int, float, str)) else type(value).__name__
                raise NotImplementedError(f"{name}={shown} is not supported: {instead}")
        elif name not in IgnoredOptions.__annotations__:
            raise TypeError(f"tetrahedralize() got an unexpected keyword argument {name!r}")
        elif name == "steinerleft" and value >= 0 and value != 100000:
            warnings.warn(f"steinerleft={value} is ignored: the number of added points is not limited", stacklevel=3)


def _faces(cells: Array, corners: int) -> Ints:
    """Faces or edges of cells, each once, with ascending corners."""
    from itertools import combinations

    chosen = [list(some) for some in combinations(range(cells.shape[1]), corners)]
    faces: Ints = np.unique(np.sort(np.concatenate([cells[:, some] for some in chosen]), axis=1), axis=0)
    return faces
