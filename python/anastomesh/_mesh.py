"""Tetrahedral meshes with a labelled boundary."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arrays, _files
from ._arrays import Array, Floats, Ints
from ._foreign import polydata_of
from .options import ConvertOptions, StrPath

if TYPE_CHECKING:
    import pyvista
    from typing_extensions import Unpack

#: Prefixes of files with values at points, tetrahedra and triangles.
_VALUES = {"point": "point_", "tet": "tet_", "triangle": "triangle_"}
#: Numbers of points of tetrahedra and triangles, by their order.
_COLUMNS = {1: (4, 3), 2: (10, 6)}
#: Triangles between the corners 0, 1, 2 and the midpoints 3, 4, 5 of a triangle of second order.
_QUARTERS = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]]
#: Names that meshio gives to cells, by their number of points.
_MESHIO = {3: "triangle", 4: "tetra", 6: "triangle6", 10: "tetra10"}
_PARTS = ("points", "tets", "tet_blocks", "triangles", "triangle_patches", "triangle_blocks")


@dataclass(frozen=True)
class Patch:
    """Part of the boundary: the wall, an inlet or outlet with its cap, or the triangles of one marker."""

    id: int
    name: str
    #: Terminal node of the given network that the cap closes.
    node: int | None = field(default=None, repr=False)
    center: tuple[float, float, float] | None = field(default=None, repr=False)
    #: Outward unit normal of the cap.
    normal: tuple[float, float, float] | None = field(default=None, repr=False)
    radius: float | None = field(default=None, repr=False)


@dataclass(eq=False, repr=False)
class Mesh:
    """A mesh: tetrahedron ``i`` has the corners ``points[tets[i]]`` and a positive volume.

    A surface that was filled keeps the order of its points and triangles; points that were added follow.

    Elements of second order have ten and six points: corners, then the midpoints of the edges 01, 12, 02, 03, 13, 23.
    """

    points: Floats
    #: Tetrahedra (m, 4), or (m, 10) with ``order=2``.
    tets: Ints
    #: Triangles of the boundary (k, 3) or (k, 6), counter-clockwise from outside.
    triangles: Ints = field(default_factory=lambda: np.zeros((0, 3), np.int32))
    #: Patch of each triangle (k,), or None.
    markers: Ints | None = None
    #: Region of each tetrahedron (m,); in the mesh of a network its block.
    regions: Ints | None = None
    patches: list[Patch] = field(default_factory=list)
    #: Table of inlets and outlets: place, area, flow, pressure and so on of each.
    terminals: list[dict[str, Any]] = field(default_factory=list)
    #: Pieces of the vessels in the cells, with ``embed=True``: columns ``edge``, ``cell``, ``start``, ``end``, ``length``, …
    embedding: dict[str, Any] = field(default_factory=dict)
    #: Values that ``data=`` asked for, as ``{("point", "radius"): array}``.
    values: dict[tuple[str, str], Array] = field(default_factory=dict)
    #: The program's report of the run; empty without one.
    report: dict[str, Any] = field(default_factory=dict)
    _blocks: Ints | None = None
    _notes: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        cells = f"{len(self.tets):,} tetrahedra, {len(self.triangles):,} triangles"
        order = ", order 2" if self.order == 2 else ""
        return f"Mesh({len(self.points):,} points, {cells}, {len(self.patches):,} patches{order})"

    @property
    def order(self) -> int:
        """Order of the elements: 2 if ``tets`` has ten columns, else 1."""
        return 2 if np.shape(self.tets)[1:] == (10,) else 1

    def patch(self, name: str) -> Ints:
        """Triangles of the patch with a name."""
        ids = [patch.id for patch in self.patches if patch.name == name]
        if not ids or self.markers is None:
            raise KeyError(f"there is no patch {name!r}: choose from {', '.join(p.name for p in self.patches)}")
        chosen: Ints = self.triangles[self.markers == ids[0]]
        return chosen

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """The tetrahedra as a ``pyvista.UnstructuredGrid``, with the cell array ``block`` and ``values``."""
        import pyvista

        kind = pyvista.CellType.QUADRATIC_TETRA if self.order == 2 else pyvista.CellType.TETRA
        grid = pyvista.UnstructuredGrid({kind: self.tets}, self.points)
        self._add_data(grid, {name: of_tets for name, (of_tets, _) in self._cell_data().items() if name != "patch"})
        return grid

    def boundary_to_pyvista(self) -> pyvista.PolyData:
        """The boundary as a ``pyvista.PolyData`` with all points, the cell arrays ``patch`` and ``block``, and ``values``.

        A triangle of second order becomes four plane triangles between its corners and midpoints.
        """
        of_cells = {name: of_triangles for name, (_, of_triangles) in self._cell_data().items()}
        triangles = self.triangles
        if self.order == 2:
            # PolyData has no curved triangles.
            triangles = triangles.reshape(-1, 6)[:, _QUARTERS].reshape(-1, 3)
            of_cells = {name: np.repeat(values, len(_QUARTERS), axis=0) for name, values in of_cells.items()}
        surface = polydata_of(self.points, triangles)
        self._add_data(surface, of_cells)
        return surface

    def _add_data(self, data_set: pyvista.DataSet, of_cells: dict[str, Array]) -> None:
        data_set.cell_data.update(of_cells)
        data_set.point_data.update(self._values("point"))

    def to_meshio(self) -> Any:
        """A ``meshio.Mesh``: cells ``tetra`` and ``triangle``, or ``tetra10`` and ``triangle6``, cell data ``patch`` and
        ``block``, the names of patches in ``field_data``."""
        import meshio

        cells = [(_MESHIO[cell.shape[1]], cell) for cell in (self.tets, self.triangles)]
        return meshio.Mesh(
            self.points,
            [(kind, cell) for kind, cell in cells if len(cell)],
            point_data=self._values("point"),
            cell_data={
                name: [values for values, (_, cell) in zip(both, cells, strict=False) if len(cell)]
                for name, both in self._cell_data().items()
            },
            field_data={patch.name: np.array([patch.id, 2]) for patch in self.patches},
        )

    def save(self, path: StrPath, **options: Unpack[ConvertOptions]) -> None:
        """Writes the mesh (.vtu, .pvtu, .msh, .msh2, .mesh, .foam, .svmesh, .ele, .npyd) or its boundary (.stl, .ply, .obj, .off,
        .glb, .3mf, .vtp); the keyword arguments are those of ``convert``.

        Only .vtu, .msh, .msh2, .npyd and .svmesh keep the midpoints of second order. Other formats leave them out with a warning.
        """
        _files.save(self, path, options)

    @classmethod
    def load(cls, path: StrPath) -> Mesh:
        """Reads a mesh in any format that the program reads."""
        if _files.is_folder_of_arrays(path):
            return cls._read(os.fspath(path))
        return _files.load(path, "mesh.npyd", cls._read)

    def _cell_data(self) -> dict[str, tuple[Array, Array]]:
        """Values of tetrahedra and of triangles, by name."""
        markers = self.markers if self.markers is not None else np.zeros(len(self.triangles), np.int32)
        regions = self.regions if self.regions is not None else np.zeros(len(self.tets), np.int32)
        blocks = self._blocks if self._blocks is not None else np.zeros(len(self.triangles), np.int32)
        data = {"patch": (np.zeros(len(self.tets), np.int32), markers), "block": (regions, blocks)}
        of_triangles = self._values("triangle")
        return {**data, **{name: (values, of_triangles[name]) for name, values in self._values("tet").items()}}

    def _values(self, at: str) -> dict[str, Array]:
        return {name: values for (where, name), values in self.values.items() if where == at}

    def _write(self, folder: str) -> str:
        """Writes it for the program and returns the path."""
        path = os.path.join(folder, "mesh.npyd")
        os.mkdir(path)
        points = _arrays.floats("points", self.points, 3)
        of_tet, of_triangle = _COLUMNS[self.order]
        tets = _arrays.indices("tets", self.tets, of_tet, "points", len(points))
        # An empty array has three columns by default.
        given = self.triangles if len(self.triangles) else np.zeros((0, of_triangle), np.int32)
        triangles = _arrays.indices("triangles", given, of_triangle, "points", len(points))
        of_tets, of_triangles = ("tets", len(tets)), ("triangles", len(triangles))
        _arrays.write(
            path,
            points=points,
            tets=tets,
            tet_blocks=None if self.regions is None else _arrays.labels("regions", self.regions, of_tets),
            # A mesh without triangles has no labelled boundary.
            triangles=triangles if len(triangles) else None,
            triangle_patches=None
            if self.markers is None or not len(triangles)
            else _arrays.labels("markers", self.markers, of_triangles),
            triangle_blocks=self._blocks if len(triangles) else None,
        )
        if self._notes or self.patches:
            with open(os.path.join(path, "mesh.json"), "w", encoding="utf-8") as file:
                json.dump({**self._notes, "patches": [_said(patch) for patch in self.patches]}, file)
        return path

    @classmethod
    def _read(cls, folder: str, report: dict[str, Any] | None = None) -> Mesh:
        """Reads what the program has written."""
        files = [name for name, kind in map(os.path.splitext, sorted(os.listdir(folder))) if kind == ".npy"]
        parts = {name: _arrays.read(folder, name) for name in _PARTS if name in files}
        values = {
            (at, name[len(prefix) :]): _arrays.read(folder, name)
            for name in files
            for at, prefix in _VALUES.items()
            if name.startswith(prefix) and name not in _PARTS
        }
        notes: dict[str, Any] = {}
        if os.path.exists(os.path.join(folder, "mesh.json")):
            with open(os.path.join(folder, "mesh.json"), encoding="utf-8") as file:
                notes = json.load(file)
        return cls(
            points=parts["points"],
            tets=parts["tets"],
            triangles=parts.get("triangles", np.zeros((0, 3), np.int32)),
            markers=parts.get("triangle_patches"),
            regions=parts.get("tet_blocks"),
            patches=[_patch(patch) for patch in notes.get("patches", [])],
            terminals=_terminals(folder),
            embedding=_embedding(folder),
            values=values,
            report=report or {},
            _blocks=parts.get("triangle_blocks"),
            _notes=notes,
        )


def _patch(said: Mapping[str, Any]) -> Patch:
    cap = said.get("cap")
    if cap is None:
        return Patch(said["id"], said["name"])
    return Patch(said["id"], said["name"], cap["node"], tuple(cap["center"]), tuple(cap["normal"]), cap["radius"])


def _said(patch: Patch) -> dict[str, Any]:
    cap = {"node": patch.node or 0, "center": patch.center, "normal": patch.normal, "radius": patch.radius}
    return {"id": patch.id, "name": patch.name, "cap": None if patch.center is None else cap}


def _terminals(folder: str) -> list[dict[str, Any]]:
    """Table of inlets and outlets, which the program writes beside the mesh of a network."""
    path = folder.removesuffix(".npyd") + "_patches.csv"
    if not os.path.exists(path):
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return [{name: _number(text) for name, text in row.items()} for row in csv.DictReader(file)]


def _embedding(folder: str) -> dict[str, Any]:
    """Table of the pieces of embedded vessels, which the program writes beside the mesh."""
    path = folder.removesuffix(".npyd") + "_embedding.csv"
    if not os.path.exists(path):
        return {}
    found = _arrays.columns(path)
    return {name: np.asarray(found[name], np.int64) if name in ("edge", "cell") else found[name] for name in found}


def _number(text: str) -> Any:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
