"""Meshes in the formats of other packages."""

from __future__ import annotations

from pathlib import Path

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
