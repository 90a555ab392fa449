"""Adapters for other packages. Each test is skipped without its package."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import anastomesh
import networkx as nx
import numpy as np
import pytest
import pyvista
from anastomesh.adapters import simvascular, slicer, svv
from conftest import Cube, volumes


def tube(*, closed: bool = True) -> pyvista.PolyData:
    """Tube of radius 1 and length 6. Closed, its cell array ``ModelFaceID`` is 1 on the wall, and 2 and 3 on the ends."""
    tube: pyvista.PolyData = (
        pyvista.Cylinder(radius=1, height=6, resolution=16, capping=closed).triangulate().subdivide(2).clean()
    )
    tube = tube.compute_normals(auto_orient_normals=True, split_vertices=False, point_normals=False)
    x = tube.cell_centers().points[:, 0]
    tube.cell_data.clear()
    tube.cell_data["ModelFaceID"] = np.where(x < -2.99, 2, np.where(x > 2.99, 3, 1)).astype(np.int32)
    return tube


def same_triangles(a: Any, b: Any) -> bool:
    return {tuple(sorted(t)) for t in np.asarray(a).tolist()} == {tuple(sorted(t)) for t in np.asarray(b).tolist()}


# --- meshio ---


@pytest.fixture
def meshio_formats() -> ModuleType:
    """The package meshio with the formats."""
    meshio = pytest.importorskip("meshio", reason="meshio is not installed")
    import anastomesh.adapters.meshio  # noqa: F401

    module: ModuleType = meshio
    return module


def test_meshio_reads_networks(meshio_formats: ModuleType, fixtures: Path, tmp_path: Path) -> None:
    read = meshio_formats.read(fixtures / "tree_30.swc")
    tree = anastomesh.Network.load(fixtures / "tree_30.swc")
    assert tree.radii is not None
    assert np.array_equal(read.points, tree.nodes) and np.array_equal(read.cells_dict["line"], tree.edges)
    assert np.array_equal(read.point_data["radius"], tree.radii)
    read.write(tmp_path / "again.npyd")
    assert np.array_equal(np.load(tmp_path / "again.npyd/radii.npy"), tree.radii)
    again = meshio_formats.read(tmp_path / "again.npyd")
    assert np.array_equal(again.points, tree.nodes) and np.array_equal(again.cells_dict["line"], tree.edges)
    by_name = meshio_formats.read(fixtures / "y_sections.h5", file_format="anastomesh-network")
    assert len(by_name.cells_dict["line"]) == len(anastomesh.Network.load(fixtures / "y_sections.h5").edges)


def test_meshio_keeps_patches(meshio_formats: ModuleType, fork: nx.Graph, tmp_path: Path) -> None:
    mesh = anastomesh.mesh(fork)
    assert mesh.markers is not None
    mesh.to_meshio().write(tmp_path / "fork.npyd")
    read = meshio_formats.read(tmp_path / "fork.npyd")
    assert np.array_equal(read.points, mesh.points) and np.array_equal(read.cells_dict["tetra"], mesh.tets)
    assert np.array_equal(read.cell_data_dict["patch"]["triangle"], mesh.markers)
    assert {name: id for name, (id, _) in read.field_data.items()} == {patch.name: patch.id for patch in mesh.patches}
    read.write(tmp_path / "fork.svmesh")
    surfaces = {path.stem for path in (tmp_path / "fork.svmesh/mesh-surfaces").iterdir()}
    assert surfaces == {"wall", "inlet", "outlet_0", "outlet_1"}


def test_meshio_writes_surfaces_of_gmsh_files(meshio_formats: ModuleType, cube: Cube, tmp_path: Path) -> None:
    points, triangles = cube
    marked = meshio_formats.Mesh(points, [("triangle", triangles)], cell_data={"gmsh:physical": [np.arange(12)]})
    surface = sys.modules["anastomesh.adapters.meshio"].from_meshio(marked)
    assert isinstance(surface, anastomesh.Surface) and surface.markers is not None and surface.markers.tolist() == list(range(12))
    marked.write(tmp_path / "cube.glb")
    assert (tmp_path / "cube.glb").read_bytes().startswith(b"glTF")
    hexahedron = meshio_formats.Mesh(points, [("hexahedron", [[0, 1, 3, 2, 4, 5, 7, 6]])])
    with pytest.raises(ValueError, match="cells of type hexahedron cannot be written"):
        hexahedron.write(tmp_path / "cube.npyd")


def test_meshio_keeps_second_order(meshio_formats: ModuleType, fork: nx.Graph, tmp_path: Path) -> None:
    mesh = anastomesh.mesh(fork, order=2)
    assert mesh.markers is not None
    mesh.to_meshio().write(tmp_path / "fork.npyd")
    read = meshio_formats.read(tmp_path / "fork.npyd")
    assert np.array_equal(read.points, mesh.points) and np.array_equal(read.cells_dict["tetra10"], mesh.tets)
    assert np.array_equal(read.cells_dict["triangle6"], mesh.triangles)
    assert np.array_equal(read.cell_data_dict["patch"]["triangle6"], mesh.markers)
    assert {name: id for name, (id, _) in read.field_data.items()} == {patch.name: patch.id for patch in mesh.patches}
    read.write(tmp_path / "fork.msh2")
    assert anastomesh.Mesh.load(tmp_path / "fork.msh2").order == 2
    mixed = meshio_formats.Mesh(mesh.points, [("tetra10", mesh.tets), ("triangle", mesh.triangles[:, :3])])
    with pytest.raises(ValueError, match="cells of type triangle cannot be written beside tetra10: use line, tetra10, triangle6"):
        mixed.write(tmp_path / "mixed.npyd")


# --- VMTK ---


@pytest.fixture
def vmtk() -> Any:
    """The module of the adapter."""
    pytest.importorskip("vmtk", reason="vmtk is not installed; it needs Python 3.12")
    from anastomesh.adapters import vmtk

    return vmtk


def grid(surface: pyvista.PolyData) -> pyvista.UnstructuredGrid:
    """The surface as a grid of triangles, as ``vmtksurfacetomesh`` makes it."""
    made = pyvista.UnstructuredGrid({pyvista.CellType.TRIANGLE: surface.regular_faces}, surface.points)
    made.cell_data["CellEntityIds"] = np.array(surface.cell_data["ModelFaceID"])
    return made


def test_vmtk_script_has_the_members_of_vmtktetgen(vmtk: Any) -> None:
    from vmtk import vmtktetgen

    def members(script: Any) -> set[tuple[str, str, str]]:
        return {(m.OptionName, m.MemberName, m.MemberType) for m in [*script.InputMembers, *script.OutputMembers]}

    ours, theirs = vmtk.vmtkAnastomesh(), vmtktetgen.vmtkTetGen()
    assert members(ours) == members(theirs) and ours.ScriptName == "vmtkanastomesh"


def test_vmtk_script_fills_a_surface(vmtk: Any) -> None:
    surface = tube()
    script = vmtk.vmtkAnastomesh()
    script.LogOn, script.ExitOnError, script.Mesh, script.NoBoundarySplit = 0, 0, grid(surface), 1
    script.Execute()
    made = pyvista.wrap(script.Mesh)
    ids = made.cell_data["CellEntityIds"]
    assert set(ids) == {0, 1, 2, 3} and np.array_equal(np.flatnonzero(ids), np.flatnonzero(made.celltypes == 5))
    assert same_triangles(made.cells_dict[5], surface.regular_faces)
    assert np.array_equal(made.points[: surface.n_points], surface.points.astype(float))
    assert made.cell_data["TetrahedronVolume"].sum() == pytest.approx(surface.volume, rel=1e-5)
    script.Mesh, script.Quality = grid(surface), 0
    script.Execute()
    assert script.Mesh.GetNumberOfCells() < made.n_cells
    script.Mesh, script.OutputSurfaceElements, script.NoBoundarySplit = grid(surface), 0, 0
    script.Quality, script.FixedVolume, script.MaxVolume = 1, 1, 0.002
    script.Execute()
    made = pyvista.wrap(script.Mesh)
    assert set(made.celltypes) == {10} and 0 < made.cell_data["TetrahedronVolume"].max() <= 0.002


def test_vmtk_script_reads_the_sizing_function(vmtk: Any) -> None:
    def filled(size: float) -> int:
        script = vmtk.vmtkAnastomesh()
        script.LogOn, script.ExitOnError, script.Mesh = 0, 0, grid(tube())
        script.NoBoundarySplit, script.UseSizingFunction = 1, 1
        with pytest.raises(RuntimeError, match="no point array 'VolumeSizingFunction'"):
            script.Execute()
        script.Mesh.point_data["VolumeSizingFunction"] = np.full(script.Mesh.n_points, size)
        script.Execute()
        return int(script.Mesh.GetNumberOfCells())

    assert filled(0.2) > 2 * filled(0.6)


def test_vmtk_script_closes_holes(vmtk: Any) -> None:
    script = vmtk.vmtkAnastomesh()
    script.LogOn, script.ExitOnError, script.Mesh = 0, 0, grid(tube(closed=False))
    with pytest.raises(RuntimeError, match="enclose no volume"):
        script.Execute()
    script.GenerateCaps = 1
    script.Execute()
    assert set(pyvista.wrap(script.Mesh).cell_data["CellEntityIds"]) == {0, 1, 2, 3}
    script.Order = 2
    with pytest.raises(RuntimeError, match="Order=2 is not supported: use 1"):
        script.Execute()


def test_vmtk_pype_and_mesh_generator(vmtk: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """``vmtkmeshgenerator`` takes ``vmtktetgen`` by its name."""
    tube(closed=False).save(tmp_path / "open.vtp")
    pypes = ["vmtkmeshgenerator -ifile open.vtp -edgelength 0.5 -ofile made.vtu"]
    pypes.append("vmtksurfacereader -ifile open.vtp --pipe vmtksurfacetomesh --pipe vmtkanastomesh -caps 1 -ofile filled.vtu")
    monkeypatch.chdir(tmp_path)
    for pype in pypes:
        monkeypatch.setattr(sys, "argv", ["vmtk", *pype.split()])
        assert vmtk.main() == 0
    for name, volume in [("made.vtu", tube().volume), ("filled.vtu", tube().volume)]:
        made = pyvista.read(tmp_path / name)
        assert made.volume == pytest.approx(volume, rel=0.03) and set(made.celltypes) == {5, 10}


# --- CFD Mesh Generator of 3D Slicer ---


@dataclass
class VolumeMeshing:
    """Fields of the pipeline's class of this name."""

    edgeLength: float = 0.5
    netgenGrading: float = 0.3


def test_slicer_back_end_keeps_the_surface() -> None:
    surface = tube()
    assert slicer.isAvailable()
    # The call of the pipeline's runNetgen.
    points, tets, triangles, ids = slicer.tetrahedralize(
        surface.points, surface.regular_faces, surface.cell_data["ModelFaceID"], maxh=0.5, grading=0.3, optimizationSteps=3
    )
    assert np.array_equal(points[: surface.n_points], surface.points.astype(float))
    assert np.array_equal(triangles, surface.regular_faces) and np.array_equal(ids, surface.cell_data["ModelFaceID"])
    assert volumes(points, tets).min() > 0 and volumes(points, tets).sum() == pytest.approx(surface.volume, rel=1e-5)
    finer = slicer.tetrahedralize(surface.points, surface.regular_faces, ids, maxh=0.2)[1]
    assert len(finer) > 2 * len(tets)
    graded = slicer.tetrahedralize(surface.points, surface.regular_faces, ids, maxh=2.0, grading=0.1)[1]
    steep = slicer.tetrahedralize(surface.points, surface.regular_faces, ids, maxh=2.0, grading=1.0)[1]
    assert len(graded) > len(steep)


def test_slicer_surface_that_faces_inwards_is_filled() -> None:
    surface = tube()
    inwards = surface.regular_faces[:, ::-1]
    points, tets, triangles, _ = slicer.tetrahedralize(surface.points, inwards, np.ones(len(inwards), int), 0.5)
    assert volumes(points, tets).min() > 0 and volumes(points, tets).sum() == pytest.approx(surface.volume, rel=1e-5)
    assert same_triangles(triangles, inwards)


def test_slicer_grid_has_tetrahedra_and_face_ids() -> None:
    surface = tube()
    made = pyvista.wrap(slicer.runAnastomesh(surface, "ModelFaceID", True, VolumeMeshing()))
    ids = made.cell_data["ModelFaceID"]
    assert np.array_equal(ids[made.celltypes == 5], surface.cell_data["ModelFaceID"]) and not ids[made.celltypes == 10].any()
    without = pyvista.wrap(slicer.runAnastomesh(surface, "ModelFaceID", False, VolumeMeshing()))
    assert set(without.celltypes) == {10} and without.n_cells == (made.celltypes == 10).sum()
    with pytest.raises(slicer.TetrahedralizationError, match="enclose no volume"):
        slicer.runAnastomesh(tube(closed=False), "ModelFaceID", True, VolumeMeshing())
    with pytest.raises(ValueError, match="cells that are not triangles"):
        slicer.runAnastomesh(pyvista.Cube(), "ModelFaceID", True, VolumeMeshing())


# --- SimVascular ---


def test_simvascular_folder_is_complete(tmp_path: Path) -> None:
    surface = tube()
    mesh = simvascular.mesh_complete(surface, tmp_path / "case.svmesh", walls=[1], inlets=[3])
    assert [patch.name for patch in mesh.patches] == ["wall", "inlet", "outlet_0"]
    inlet = mesh.patches[1]
    assert inlet.center == pytest.approx((3, 0, 0), abs=1e-6) and inlet.normal == pytest.approx((1, 0, 0), abs=1e-6)
    cap = pyvista.read(tmp_path / "case.svmesh/mesh-surfaces/inlet.vtp")
    assert cap.n_cells == (surface.cell_data["ModelFaceID"] == 3).sum() and cap.points[:, 0] == pytest.approx(3)
    assert pyvista.read(tmp_path / "case.svmesh/mesh-complete.mesh.vtu").n_cells == len(mesh.tets)
    conditions = {bc.get("name"): bc for bc in ElementTree.parse(tmp_path / "case.svmesh/solver.xml").iter("Add_BC")}
    assert set(conditions) == {"wall", "inlet", "outlet_0"}
    # Flow into the volume is negative.
    rows = (tmp_path / "case.svmesh/inlet.flow").read_text().split("\n")[1:]
    assert float(rows[-2].split()[1]) < 0


def test_simvascular_faces_are_checked(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no face 7: its faces are 1, 2, 3"):
        simvascular.mesh_complete(tube(), tmp_path / "case", walls=[1], inlets=[7])
    with pytest.raises(ValueError, match="no cell array 'Faces'"):
        simvascular.mesh_complete(tube(), tmp_path / "case", walls=[1], inlets=[2], face_ids="Faces")


# --- svVascularize ---


def vessels(*ends_and_radii: tuple[tuple[float, ...], tuple[float, ...], float]) -> Any:
    """Array with the columns of a tree's ``data``."""
    data = np.full((len(ends_and_radii), 31), np.nan)
    for row, (start, end, radius) in zip(data, ends_and_radii, strict=True):
        row[:3], row[3:6], row[21] = start, end, radius
    return data


def test_svv_forest_with_connections() -> None:
    """Two trees of one vessel each, which a curve of two vessels connects."""
    a = SimpleNamespace(data=vessels(((0, 0, 0), (0, 0, 10), 1.0)))
    b = SimpleNamespace(data=vessels(((20, 0, 0), (20, 0, 10), 0.8)))
    curves = [[np.array([[0, 0, 10, 10, 0, 14, 0.7]])], [np.array([[20, 0, 10, 10, 0, 14, 0.6]])]]
    joined = SimpleNamespace(connected_network=[a, b], vessels=curves)
    forest = SimpleNamespace(networks=[[a, b]], connections=SimpleNamespace(tree_connections=[joined]))
    network = svv.network(forest)
    assert len(network.nodes) == 5 and network.roots is not None
    assert network.nodes[network.roots].tolist() == [[0, 0, 0], [20, 0, 0]]
    assert network.edge_radii is not None and network.edge_radii.tolist() == [1.0, 0.8, 0.7, 0.6]
    assert anastomesh.info(network)["components"] == 1
    apart = svv.network(SimpleNamespace(networks=[[a, b]], connections=None))
    assert anastomesh.info(apart)["components"] == 2
    mesh = svv.mesh(forest, wall="0.2r")
    assert {patch.name for patch in mesh.patches} >= {"inlet", "inlet_1", "interface_lumen_wall", "wall_outer"}


def test_svv_tree_that_was_grown() -> None:
    pytest.importorskip("svv", reason="svVascularize is not installed")
    from svv.domain.domain import Domain
    from svv.tree.tree import Tree

    domain = Domain(pyvista.Cube(x_length=4, y_length=4, z_length=4).triangulate().subdivide(1))
    domain.create()
    domain.solve()
    domain.build()
    tree = Tree()
    tree.set_domain(domain)
    tree.set_root()
    tree.n_add(3)
    network = svv.network(tree)
    assert len(network.edges) == tree.segment_count == 7 and len(network.nodes) == 8
    mesh = svv.mesh(tree)
    assert anastomesh.check(mesh).valid
    assert sorted(patch.name for patch in mesh.patches) == ["inlet", "outlet_0", "outlet_1", "outlet_2", "outlet_3", "wall"]
    inlet = mesh.patches[1]
    assert inlet.name == "inlet" and inlet.center == pytest.approx(tree.data[0, :3], abs=tree.data[0, 21] / 10)
