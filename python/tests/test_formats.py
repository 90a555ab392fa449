"""Meshes in the formats of other packages."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import anastomesh
import networkx as nx
import numpy as np
import pytest
import pyvista
from anastomesh import Mesh
from conftest import volumes


@pytest.fixture
def mesh(fork: nx.Graph) -> Mesh:
    return anastomesh.mesh(fork, data=["radius", "node"])


def test_pyvista(mesh: Mesh) -> None:
    assert mesh.markers is not None
    grid = mesh.to_pyvista()
    assert isinstance(grid, pyvista.UnstructuredGrid) and grid.n_cells == len(mesh.tets)
    assert grid.volume == pytest.approx(volumes(mesh.points, mesh.tets).sum())
    assert set(grid.cell_data) == {"block", "node"} and set(grid.point_data) == {"radius"}
    surface = mesh.boundary_to_pyvista()
    assert surface.is_manifold and surface.n_cells == len(mesh.triangles)
    assert np.array_equal(surface.cell_data["patch"], mesh.markers)


def test_meshio(mesh: Mesh, tmp_path: Path) -> None:
    assert mesh.markers is not None
    theirs = mesh.to_meshio()
    assert np.array_equal(theirs.cells_dict["tetra"], mesh.tets)
    assert np.array_equal(theirs.get_cell_data("patch", "triangle"), mesh.markers)
    assert theirs.field_data["outlet_0"].tolist() == [3, 2]
    theirs.write(tmp_path / "their.vtu")


@pytest.mark.parametrize("name", ["x.vtu", "x.msh", "x.npyd"])
def test_what_is_saved_is_loaded(mesh: Mesh, tmp_path: Path, name: str) -> None:
    mesh.save(tmp_path / name)
    back = Mesh.load(tmp_path / name)
    assert np.array_equal(back.points, mesh.points)
    assert len(back.tets) == len(mesh.tets)
    assert {p.name for p in back.patches} == {p.name for p in mesh.patches}
    assert anastomesh.check(tmp_path / name)


def test_numpy_alone_reads_and_writes_a_mesh(mesh: Mesh, tmp_path: Path) -> None:
    mesh.save(tmp_path / "x.npyd")
    assert np.array_equal(np.load(tmp_path / "x.npyd" / "tets.npy", mmap_mode="r"), mesh.tets)
    folder = tmp_path / "mine.npyd"
    folder.mkdir()
    np.save(folder / "points.npy", np.vstack([np.zeros(3), np.eye(3)]))
    np.save(folder / "tets.npy", [[0, 1, 2, 3]])
    assert anastomesh.check(folder).report["verdict"] == "no_fault_found"
    np.save(folder / "tets.npy", [[0, 1, 2, 4]])
    with pytest.raises(anastomesh.InputError, match="tets.npy: row 0 refers to 4, but points.npy has 4 rows"):
        anastomesh.check(folder)


def test_a_boundary_is_written(mesh: Mesh, tmp_path: Path) -> None:
    assert mesh.markers is not None
    mesh.save(tmp_path / "wall.stl", no_caps=True)
    assert pyvista.read(tmp_path / "wall.stl").n_cells == (mesh.markers == 1).sum()
    with pytest.raises(anastomesh.Error):
        mesh.save(tmp_path / "x.unknown")


# --- Second order ---

#: Ends of the edges whose midpoints follow the corners of a tetrahedron.
EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


@pytest.fixture
def curved(fork: nx.Graph) -> Mesh:
    return anastomesh.mesh(fork, order=2, data=["radius", "node"])


def edge_lengths(mesh: Mesh, ends: list[tuple[int, int]]) -> Any:
    return np.array([np.linalg.norm(mesh.points[mesh.tets[:, a]] - mesh.points[mesh.tets[:, b]], axis=1) for a, b in ends])


def test_columns_of_second_order(mesh: Mesh, curved: Mesh) -> None:
    assert mesh.order == 1 and curved.order == 2 and repr(curved).endswith(", order 2)")
    assert curved.tets.shape == (len(mesh.tets), 10) and curved.triangles.shape == (len(mesh.triangles), 6)
    assert len(curved.values["point", "radius"]) == len(curved.points)
    middle = np.array([curved.points[curved.tets[:, [a, b]]].mean(axis=1) for a, b in EDGES])
    off = np.linalg.norm(middle - curved.points[curved.tets[:, 4:]].swapaxes(0, 1), axis=2)
    # Midpoints at the wall leave their straight edges.
    assert 0 < off.max() and (off < 0.3 * edge_lengths(curved, EDGES)).all()
    assert {tuple(t) for t in np.sort(curved.patch("wall")[:, 3:]).tolist()} <= {
        tuple(sorted(t[list(face)].tolist())) for t in curved.tets for face in [(4, 5, 6), (4, 8, 7), (5, 9, 8), (6, 9, 7)]
    }
    assert anastomesh.check(curved)


def test_second_order_of_a_surface(fixtures: Path) -> None:
    torus = anastomesh.tetrahedralize(fixtures / "torus.off", order=2)
    assert torus.order == 2 and torus.tets.shape[1] == 10 and anastomesh.check(torus)


def test_second_order_in_pyvista(curved: Mesh) -> None:
    assert curved.markers is not None
    grid = curved.to_pyvista()
    assert set(grid.celltypes) == {pyvista.CellType.QUADRATIC_TETRA} and grid.n_cells == len(curved.tets)
    assert len(grid.point_data["radius"]) == len(curved.points) and len(grid.cell_data["node"]) == len(curved.tets)
    straight = volumes(curved.points, curved.tets).sum()
    surface = curved.boundary_to_pyvista()
    assert surface.is_manifold and surface.n_cells == 4 * len(curved.triangles)
    assert np.array_equal(surface.cell_data["patch"], np.repeat(curved.markers, 4))
    # VTK measures a cell of second order by its linear pieces. The plane triangles bound them.
    assert straight < surface.volume == pytest.approx(grid.volume)


def test_second_order_in_meshio(curved: Mesh, tmp_path: Path) -> None:
    assert curved.markers is not None
    theirs = curved.to_meshio()
    assert np.array_equal(theirs.cells_dict["tetra10"], curved.tets)
    assert np.array_equal(theirs.get_cell_data("patch", "triangle6"), curved.markers)
    theirs.write(tmp_path / "their.vtu")
    assert Mesh.load(tmp_path / "their.vtu").order == 2


@pytest.mark.parametrize("name", ["x.vtu", "x.msh", "x.msh2", "x.npyd"])
def test_second_order_is_saved_and_loaded(curved: Mesh, tmp_path: Path, name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        curved.save(tmp_path / name)
    back = Mesh.load(tmp_path / name)
    assert np.array_equal(back.points, curved.points)
    assert {tuple(t) for t in back.tets.tolist()} == {tuple(t) for t in curved.tets.tolist()}
    assert {tuple(t) for t in back.triangles.tolist()} == {tuple(t) for t in curved.triangles.tolist()}
    assert {p.name for p in back.patches} == {p.name for p in curved.patches}
    assert anastomesh.check(tmp_path / name)


def test_formats_without_second_order_warn(curved: Mesh, tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="x.mesh: midpoints of second-order elements left out") as caught:
        curved.save(tmp_path / "x.mesh")
    assert caught[0].filename == __file__
    assert Mesh.load(tmp_path / "x.mesh").order == 1
    with pytest.warns(UserWarning, match="y.mesh: midpoints") as caught:
        anastomesh.convert(curved, tmp_path / "y.mesh")
    assert caught[0].filename == __file__


def test_second_order_of_arrays(tmp_path: Path) -> None:
    corners = np.vstack([np.zeros(3), np.eye(3)])
    points = np.vstack([corners, [corners[[a, b]].mean(axis=0) for a, b in EDGES]])
    one = Mesh(points, np.arange(10).reshape(1, 10))
    one.save(tmp_path / "one.vtu")
    back = Mesh.load(tmp_path / "one.vtu")
    # The program renumbers midpoints in the order of their edges.
    assert one.order == 2 and np.array_equal(back.points[back.tets], points[one.tets])
    assert one.to_pyvista().volume == pytest.approx(1 / 6) and one.boundary_to_pyvista().n_cells == 0
    with pytest.raises(ValueError, match=r"triangles: the shape is \(1, 3\): give an array of shape \(n, 6\)"):
        Mesh(points, one.tets, np.array([[0, 2, 1]])).save(tmp_path / "x.vtu")
    with pytest.raises(ValueError, match=r"tets: the shape is \(1, 5\)"):
        Mesh(points, np.arange(5).reshape(1, 5)).save(tmp_path / "x.vtu")
    with pytest.raises(anastomesh.UsageError):
        anastomesh.tetrahedralize(points[:4], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], order=3)
