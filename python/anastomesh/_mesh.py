"""Tetrahedral meshes with a labelled boundary."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from . import _arrays
from ._arrays import Array, Floats, Ints
from ._run import arguments, run, work_folder

#: What values beside a mesh are called in the folder, by where they are.
_VALUES = {"point": "point_", "tet": "tet_", "triangle": "triangle_"}
_PARTS = ("points", "tets", "tet_blocks", "triangles", "triangle_patches", "triangle_blocks")


@dataclass(frozen=True)
class Patch:
    """A part of the boundary: the wall, an inlet or outlet with its disc, or what has one marker."""

    id: int
    name: str
    #: The terminal node that the disc closes, in the order of the network that was given.
    node: int | None = None
    center: tuple[float, float, float] | None = None
    #: Out of the mesh, of length 1.
    normal: tuple[float, float, float] | None = None
    radius: float | None = None


@dataclass(eq=False)
class Mesh:
    """A mesh: tetrahedron ``i`` has the corners ``points[tets[i]]`` and a positive volume.

    ``triangles`` (k, 3) are its boundary, seen from outside counter-clockwise, with ``markers`` (k,), the patch of each; of a
    surface that was filled they are its triangles in their order. ``regions`` (m,) are the regions of the tetrahedra, or the
    blocks that the mesh of a network is made of. ``report`` is what the program says of the run, ``terminals`` what it knows of
    each inlet and outlet (place, area, flow, pressure, ...), ``values`` what ``data=`` asked for, as
    ``{("point", "radius"): array}``.
    """

    points: Floats
    tets: Ints
    triangles: Ints = field(default_factory=lambda: np.zeros((0, 3), np.int32))
    markers: Ints | None = None
    regions: Ints | None = None
    patches: list[Patch] = field(default_factory=list)
    terminals: list[dict[str, Any]] = field(default_factory=list, repr=False)
    values: dict[tuple[str, str], Array] = field(default_factory=dict, repr=False)
    report: dict[str, Any] | None = field(default=None, repr=False)
    _blocks: Ints | None = field(default=None, repr=False)
    _notes: dict[str, Any] = field(default_factory=dict, repr=False)

    def patch(self, name: str) -> Ints:
        """The triangles of the patch of a name."""
        ids = [patch.id for patch in self.patches if patch.name == name]
        if not ids or self.markers is None:
            raise KeyError(f"there is no patch {name!r}; there are {', '.join(p.name for p in self.patches)}")
        chosen: Ints = self.triangles[self.markers == ids[0]]
        return chosen

    def to_pyvista(self) -> Any:
        """The tetrahedra as a ``pyvista.UnstructuredGrid``, with the cell array ``block`` and ``values``."""
        import pyvista

        grid = pyvista.UnstructuredGrid({pyvista.CellType.TETRA: self.tets}, self.points)
        return self._with_data(grid, {name: of_tets for name, (of_tets, _) in self._cell_data().items() if name != "patch"})

    def boundary_to_pyvista(self) -> Any:
        """The boundary as a ``pyvista.PolyData`` on all points, with the cell arrays ``patch`` and ``block`` and ``values``."""
        import pyvista

        surface = pyvista.PolyData.from_regular_faces(self.points, self.triangles.astype(int))
        return self._with_data(surface, {name: of_triangles for name, (_, of_triangles) in self._cell_data().items()})

    def _with_data(self, data_set: Any, of_cells: dict[str, Array]) -> Any:
        data_set.cell_data.update(of_cells)
        data_set.point_data.update(self._values("point"))
        return data_set

    def to_meshio(self) -> Any:
        """A ``meshio.Mesh``: cells ``tetra`` and ``triangle``, cell data ``patch`` and ``block``, the names of patches in
        ``field_data``."""
        import meshio

        cells = [("tetra", self.tets), ("triangle", self.triangles)]
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

    def save(self, path: str | os.PathLike[str], **options: Any) -> None:
        """Writes it in any format of ``anastomesh convert``: .vtu, .pvtu, .msh, .msh2, .mesh, .foam, .svmesh, .ele, .npyd, or the
        boundary as .stl, .ply, .obj, .off, .glb, .3mf, .vtp."""
        with work_folder() as folder:
            done = run("convert", [self._write(folder), f"--output={os.fspath(path)}", *arguments(options)], folder=folder)
            if done.code:
                raise done.error()

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Mesh:
        """Reads a mesh in any format that the program reads."""
        if os.path.isdir(path) and os.fspath(path).endswith(".npyd"):
            return cls._read(os.fspath(path), None)
        with work_folder() as folder:
            out = os.path.join(folder, "mesh.npyd")
            done = run("convert", [os.fspath(path), f"--output={out}"], folder=folder)
            if done.code:
                raise done.error()
            return cls._read(out, None)

    def _cell_data(self) -> dict[str, tuple[Array, Array]]:
        """Of tetrahedra and of triangles."""
        markers = self.markers if self.markers is not None else np.zeros(len(self.triangles), np.int32)
        regions = self.regions if self.regions is not None else np.zeros(len(self.tets), np.int32)
        blocks = self._blocks if self._blocks is not None else np.zeros(len(self.triangles), np.int32)
        data = {"patch": (np.zeros(len(self.tets), np.int32), markers), "block": (regions, blocks)}
        of_triangles = self._values("triangle")
        return {**data, **{name: (values, of_triangles[name]) for name, values in self._values("tet").items()}}

    def _values(self, at: str) -> dict[str, Array]:
        return {name: values for (where, name), values in self.values.items() if where == at}

    def _write(self, folder: str) -> str:
        """Writes it for the program; returns the path."""
        path = os.path.join(folder, "given.npyd")
        os.mkdir(path)
        points = _arrays.floats("points", self.points, 3)
        tets = _arrays.indices("tets", self.tets, 4, "points", len(points))
        triangles = _arrays.indices("triangles", self.triangles, 3, "points", len(points))
        of_tets, of_triangles = ("tets", len(tets)), ("triangles", len(triangles))
        _arrays.write(
            path,
            points=points,
            tets=tets,
            tet_blocks=None if self.regions is None else _arrays.labels("regions", self.regions, of_tets),
            # Without any the boundary is not labelled.
            triangles=triangles if len(triangles) else None,
            triangle_patches=None
            if self.markers is None or not len(triangles)
            else _arrays.labels("markers", self.markers, of_triangles),
            triangle_blocks=self._blocks if len(triangles) else None,
        )
        if self._notes:
            with open(os.path.join(path, "mesh.json"), "w", encoding="utf-8") as file:
                json.dump(self._notes, file)
        return path

    @classmethod
    def _read(cls, folder: str, report: dict[str, Any] | None) -> Mesh:
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
            values=values,
            report=report,
            _blocks=parts.get("triangle_blocks"),
            _notes=notes,
        )


def _patch(said: Mapping[str, Any]) -> Patch:
    cap = said.get("cap")
    if cap is None:
        return Patch(said["id"], said["name"])
    return Patch(said["id"], said["name"], cap["node"], tuple(cap["center"]), tuple(cap["normal"]), cap["radius"])


def _terminals(folder: str) -> list[dict[str, Any]]:
    """The table of inlets and outlets that the program writes beside the mesh of a network."""
    path = folder.removesuffix(".npyd") + "_patches.csv"
    if not os.path.exists(path):
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return [{name: _number(text) for name, text in row.items()} for row in csv.DictReader(file)]


def _number(text: str) -> Any:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
