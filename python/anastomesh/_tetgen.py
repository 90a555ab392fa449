"""The class that users of PyPI's ``tetgen`` know: where ``tetgen.TetGen`` is called, ``anastomesh.TetGen`` can be."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from ._api import tetrahedralize as _tetrahedralize
from ._arrays import Array, Floats, Ints
from ._mesh import Mesh
from ._progress import ProgressLike

#: Keywords that say how TetGen goes about it: nothing here depends on them.
_WITHOUT_EFFECT = frozenset(
    """brio_hilbert flipinsert diagnose noexact nostaticfilter zeroindex neighout meditview vtkview vtksurfview nobound
    nonodewritten noelewritten nofacewritten noiterationnum docheck quiet nowarning verbose vertexperblock
    tetrahedraperblock shellfaceperblock supsteiner_level addsteiner_algo cdtrefine coarsen_param weighted_param
    fliplinklevel flipstarsize fliplinklevelinc opt_max_flip_level opt_scheme opt_iterations smooth_cirterion
    smooth_maxiter delmaxfliplevel reversetetori steinerleft unflip_queue_limit no_sort hilbert_order hilbert_limit
    brio_threshold brio_ratio opt_max_asp_ratio opt_max_edge_ratio optmaxdihedral smooth_alpha
    refine_progress_ratio maxvolume_length nomergefacet nomergevertex nojettison epsilon facet_separate_ang_tol
    collinear_ang_tol facet_small_ang_tol""".split()
)

#: Keywords that ask for something else than is made here, unless they have these values.
_REFUSED: dict[str, tuple[Any, str]] = {
    "psc": (False, "there are no curved surfaces"),
    "refine": (False, "a mesh cannot be refined: mesh its surface anew with the bounds that you want"),
    "cdt": (False, "the boundary is split (nobisect=False) or kept (nobisect=True)"),
    "coarsen": (False, "meshes are not made coarser"),
    "weighted": (False, "there are no weights"),
    "metric": (False, "there is no background mesh: give maxvolume, or add_region with max_vol"),
    "insertaddpoints": (False, "there is no list of points to be inserted: give them as points of the surface"),
    "convex": (False, "the convex hull is not filled: give the points alone to anastomesh.tetrahedralize"),
    "voroout": (False, "there is no Voronoi diagram"),
    "bgmesh": (None, "there is no background mesh: give maxvolume, or add_region with max_vol"),
    "bgmeshfilename": ("", "there is no background mesh: give maxvolume, or add_region with max_vol"),
    "coarsen_percent": (1.0, "meshes are not made coarser"),
    "metric_scale": (1.0, "there is no background mesh"),
    "elem_growth_ratio": (0.0, "there is no background mesh"),
}


class TetGen:
    """A surface on its way to a mesh: ``TetGen(polydata)``, ``TetGen(points, triangles)`` or ``TetGen(path)``."""

    def __init__(self, arg0: Any, arg1: Any = None, arg2: Any = None) -> None:
        self._markers = arg2
        self._holes: list[Sequence[float]] = []
        self._regions: list[tuple[Sequence[float], int, float]] = []
        self._repairs = False
        self._all_edges = self._all_faces = False
        self._made: Mesh | None = None
        if isinstance(arg0, (str, os.PathLike)):
            import pyvista

            arg0 = pyvista.read(os.fspath(arg0))
        if arg1 is None:
            if not hasattr(arg0, "faces"):
                raise TypeError("a surface is needed: a PolyData, points and triangles, or the path of a file")
            if not getattr(arg0, "is_all_triangles", True):
                raise RuntimeError("Invalid mesh. Must be an all triangular mesh.")
            self.v: Floats = np.asarray(arg0.points, dtype=np.float64)
            self.f: Ints = np.asarray(arg0.faces).reshape(-1, 4)[:, 1:]
        else:
            self.v, self.f = np.asarray(arg0, dtype=np.float64), np.asarray(arg1)

    def add_hole(self, point_in_hole: Sequence[float]) -> None:
        """The part of space around a point stays empty."""
        self._holes.append(point_in_hole)

    def add_region(self, id: int, point_in_region: Sequence[float], max_vol: float = 0.0) -> None:
        """The part of space around a point has a number, and may have a bound on its volumes."""
        self._regions.append((point_in_region, id, max_vol))

    def make_manifold(self, verbose: bool = False) -> None:
        """Has the surface repaired when it is filled: triangles turned, what is there twice joined; nothing else."""
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
        **others: Any,
    ) -> tuple[Floats, Ints, Floats, Ints]:
        """Fills the surface: points, tetrahedra, regions of the tetrahedra (with ``regionattrib``) and markers of the faces.

        Keywords that only say how TetGen goes about it are passed over; what asks for another result is refused with a
        ``NotImplementedError``. ``switches`` are TetGen's, instead of all keywords.
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
        """Whether there is a mesh."""
        return self._made is not None

    @property
    def _mesh(self) -> Mesh:
        if self._made is None:
            raise AttributeError("there is no mesh yet: run tetrahedralize() first")
        return self._made

    @property
    def node(self) -> Floats:
        """Points (n, 3): those of the surface first, in their order."""
        return self._mesh.points

    @property
    def elem(self) -> Ints:
        """Tetrahedra (m, 4)."""
        return self._mesh.tets

    @property
    def attributes(self) -> Floats:
        """Region of each tetrahedron (m, 1); empty where none were asked for."""
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
    def grid(self) -> Any:
        """The tetrahedra as a ``pyvista.UnstructuredGrid``."""
        import pyvista

        grid = pyvista.UnstructuredGrid({pyvista.CellType.TETRA: self.elem}, self.node)
        if len(self.attributes):
            grid.cell_data["regions"] = self.attributes[:, 0]
        return grid

    @property
    def mesh(self) -> Any:
        """The surface as a ``pyvista.PolyData``."""
        import pyvista

        return pyvista.PolyData.from_regular_faces(self.v, self.f.astype(int))

    def plot(self, **options: Any) -> Any:
        """Shows the mesh."""
        return self.grid.plot(**options)

    def write(self, filename: str | os.PathLike[str], binary: bool = True) -> None:
        """Writes the mesh by pyvista: .vtk or .vtu."""
        self.grid.save(os.fspath(filename), binary=binary)


def _refuse(others: dict[str, Any], order: int) -> None:
    """Says of keywords what they would have done."""
    if order != 1:
        raise NotImplementedError(f"order={order}: tetrahedra have four corners here; order=1 is what there is")
    for name, value in others.items():
        if name in _REFUSED:
            usual, instead = _REFUSED[name]
            if value is not usual and value != usual:
                shown = repr(value) if isinstance(value, (bool, int, float, str)) else type(value).__name__
                raise NotImplementedError(f"{name}={shown} is not supported: {instead}")
        elif name not in _WITHOUT_EFFECT:
            raise TypeError(f"{name} is no keyword of TetGen.tetrahedralize")
        elif name == "steinerleft" and value >= 0 and value != 100000:
            warnings.warn(f"steinerleft={value}: the number of points that are added is not bounded", stacklevel=3)


def _faces(cells: Array, corners: int) -> Ints:
    """The faces or edges of cells, each once, its corners ascending."""
    from itertools import combinations

    chosen = [list(some) for some in combinations(range(cells.shape[1]), corners)]
    return np.unique(np.sort(np.concatenate([cells[:, some] for some in chosen]), axis=1), axis=0)
