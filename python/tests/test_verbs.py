"""Functions give the same results as the program."""

from __future__ import annotations

import filecmp
import subprocess
from pathlib import Path
from typing import Any

import anastomesh
import networkx as nx
import numpy as np
import pytest
import pyvista
import trimesh
from anastomesh import Mesh, Network, Surface
from conftest import Cube


def run(*words: str | Path) -> None:
    subprocess.run([anastomesh.binary(), *map(str, words), "-q"], check=True, capture_output=True)


def same(one: Path, other: Path) -> bool:
    return filecmp.cmp(one, other, shallow=False)


def equal(one: Any, other: Any) -> bool:
    """Equality of all arrays of two results."""
    arrays = {name: value for name, value in vars(one).items() if isinstance(value, np.ndarray)}
    return bool(arrays) and all(np.array_equal(value, getattr(other, name)) for name, value in arrays.items())


def test_meshes_have_the_same_bytes(fixtures: Path, tmp_path: Path) -> None:
    tree = fixtures / "tree_30.vtp"
    run("mesh", tree, "-o", tmp_path / "program.vtu", "--rho", "4", "--layers", "2")
    anastomesh.mesh(tree, rho=4, layers=2).save(tmp_path / "python.vtu")
    assert same(tmp_path / "program.vtu", tmp_path / "python.vtu")
    run("tetrahedralize", fixtures / "torus.off", "-o", tmp_path / "program.msh", "--no-refine")
    anastomesh.tetrahedralize(fixtures / "torus.off", refine=False).save(tmp_path / "python.msh")
    assert same(tmp_path / "program.msh", tmp_path / "python.msh")


def test_surface(fixtures: Path, tmp_path: Path) -> None:
    run("surface", fixtures / "tree_30.vtp", "-o", tmp_path / "program.ply")
    wall = anastomesh.surface(fixtures / "tree_30.vtp")
    wall.save(tmp_path / "python.ply")
    assert same(tmp_path / "program.ply", tmp_path / "python.ply")
    assert repr(wall) == f"Surface({len(wall.points):,} points, {len(wall.triangles):,} triangles)"
    assert wall.markers is not None and wall.report["check"]["verdict"] == "valid"
    assert wall.to_pyvista().is_manifold
    opened = anastomesh.surface(fixtures / "tree_30.vtp", no_caps=True)
    assert len(opened.triangles) == (wall.markers == 1).sum()
    for name in ("wall.off", "wall.stl"):
        wall.save(tmp_path / name)
        assert len(Surface.load(tmp_path / name).triangles) == len(wall.triangles)
    mesh = anastomesh.tetrahedralize(wall, refine=False)
    assert mesh.markers is not None and np.array_equal(mesh.markers, wall.markers)


@pytest.mark.parametrize("verb", ["prepare", "refine", "dual"])
def test_networks_from_networks(verb: str, fixtures: Path, tmp_path: Path) -> None:
    run(verb, fixtures / "tree_30.vtp", "-o", tmp_path / "program.npyd")
    made: Network = getattr(anastomesh, verb)(fixtures / "tree_30.vtp")
    assert equal(made, Network.load(tmp_path / "program.npyd")) and made.report
    assert made.original_node is not None
    assert repr(made) == f"Network({len(made.nodes):,} nodes, {len(made.edges):,} edges)"
    assert (len(made.nodes) > 30) == (verb == "dual")


def test_prepare_keeps_labels(fork: nx.Graph) -> None:
    assert anastomesh.prepare(fork, keep_points=True).labels == list(fork)


def test_generate(tmp_path: Path) -> None:
    run("generate", "--terminals", "20", "--organ", "ellipsoid", "--seed", "3", "-o", tmp_path / "program.npyd")
    grown = anastomesh.generate(20, organ="ellipsoid", seed=3)
    assert equal(grown, Network.load(tmp_path / "program.npyd"))
    assert anastomesh.info(grown)["terminals"] == 21
    with pytest.raises(anastomesh.UsageError):
        anastomesh.generate(0)


def test_info(fork: nx.Graph, fixtures: Path) -> None:
    found = anastomesh.info(fork, units="um:m")
    assert (found["nodes"], found["edges"], found["terminals"]) == (4, 3, 3)
    assert found["radius"]["max"] == pytest.approx(1e-6)
    assert anastomesh.info(fixtures / "tree_30.swc")["nodes"] == 30


def test_pictures(fork: nx.Graph, tmp_path: Path) -> None:
    mesh = anastomesh.mesh(fork)
    mesh.save(tmp_path / "mesh.npyd")
    words: list[str | Path] = ["--size", "160x120", "--clip", "y", "--color", "quality"]
    run("render", tmp_path / "mesh.npyd", "-o", tmp_path / "program.png", *words)
    picture = anastomesh.render(mesh, size=(160, 120), clip="y", color="quality")
    assert picture == (tmp_path / "program.png").read_bytes() and picture._repr_png_() == picture
    assert anastomesh.render(mesh, tmp_path / "mine.png", size="160x120") == (tmp_path / "mine.png").read_bytes()
    radii = anastomesh.render(mesh, network=fork, color="radius", size=(160, 120))
    assert radii != anastomesh.render(mesh, size=(160, 120))
    for drawn in (fork, anastomesh.surface(fork), mesh.boundary_to_pyvista(), tmp_path / "mesh.npyd"):
        assert anastomesh.render(drawn, size=(80, 60)).startswith(b"\x89PNG")
    with pytest.raises(anastomesh.UsageError, match="invalid value 'w' for 'clip='"):
        anastomesh.render(mesh, clip="w")


def test_pages(fork: nx.Graph, tmp_path: Path) -> None:
    mesh = anastomesh.mesh(fork)
    mesh.save(tmp_path / "mesh.npyd")
    run("view", tmp_path / "mesh.npyd", "-o", tmp_path / "program.html")
    anastomesh.view(mesh, tmp_path / "python.html")
    assert same(tmp_path / "program.html", tmp_path / "python.html")
    anastomesh.view(mesh, tmp_path / "named.html", network=fork, check=False)
    assert not same(tmp_path / "named.html", tmp_path / "python.html")


def test_convert(fork: nx.Graph, cube: Cube, tmp_path: Path) -> None:
    mesh = anastomesh.mesh(fork)
    mesh.save(tmp_path / "mesh.vtu")
    run("convert", tmp_path / "mesh.vtu", "-o", tmp_path / "program.msh")
    anastomesh.convert(tmp_path / "mesh.vtu", tmp_path / "file.msh")
    anastomesh.convert(mesh, tmp_path / "mesh.msh")
    assert same(tmp_path / "program.msh", tmp_path / "file.msh") and same(tmp_path / "file.msh", tmp_path / "mesh.msh")
    mesh.save(tmp_path / "wrong.vtu", format="msh")
    assert same(tmp_path / "program.msh", tmp_path / "wrong.vtu")
    anastomesh.convert(fork, tmp_path / "fork.swc")
    assert len(Network.load(tmp_path / "fork.swc").edges) == 3
    anastomesh.convert(trimesh.Trimesh(*cube), tmp_path / "cube.off")
    assert len(Surface.load(tmp_path / "cube.off").triangles) == 12


def test_check_reports_conditions(fork: nx.Graph) -> None:
    mesh = anastomesh.mesh(fork)
    report = anastomesh.check(mesh)
    assert report.valid and report.verdict == "valid" and report.counts["tets"] == len(mesh.tets)
    assert len(report.conditions) > 20 and repr(report) == "CheckReport(valid)"
    mesh.tets[5] = mesh.tets[5][[1, 0, 2, 3]]
    failed = anastomesh.check(mesh).failed
    assert failed[0].name == "positive_tets" and failed[0].count == 1
    assert failed[0].places[0].kind == "tet" and failed[0].places[0].ids == (5,)
    corners = mesh.points[mesh.tets[5]]
    assert (corners.min(axis=0) <= failed[0].places[0].position).all()
    assert str(failed[0]).startswith("positive_tets fails at 1 place, the first at (")


def test_estimate_and_shards(fixtures: Path, tmp_path: Path) -> None:
    tree = fixtures / "tree_30.vtp"
    whole = anastomesh.mesh(tree)
    assert anastomesh.estimate(tree)["estimate"]["tets"] == pytest.approx(len(whole.tets), rel=0.3)
    for i in (1, 2):
        anastomesh.mesh_shard(tree, shard=(i, 2), work_dir=tmp_path / "work")
    assert equal(anastomesh.mesh(tree, work_dir=tmp_path / "work"), whole)
    with pytest.raises(anastomesh.UsageError, match="work_dir="):
        anastomesh.mesh_shard(tree, shard=(1, 2))


def test_check_surface(cube: Cube) -> None:
    points, triangles = cube
    assert anastomesh.check_surface(points, triangles)["report"]["input"]["triangles"] == 12
    with pytest.raises(anastomesh.InputError, match="open"):
        anastomesh.check_surface(points, triangles[1:])


def test_surfaces_of_other_packages(cube: Cube) -> None:
    mesh = anastomesh.tetrahedralize(*cube)
    points: Any = cube[0]
    polydata: Any = pyvista.PolyData.from_regular_faces(points, cube[1].astype(int))
    for surface in (trimesh.Trimesh(*cube, process=False), polydata, Surface(*cube)):
        assert equal(anastomesh.tetrahedralize(surface), mesh)
    assert len(anastomesh.TetGen(trimesh.Trimesh(*cube)).tetrahedralize(nobisect=True)[1]) > 4
    with pytest.raises(TypeError, match="a network is needed, not Trimesh"):
        anastomesh.mesh(trimesh.Trimesh(*cube))  # type: ignore[arg-type]


def test_lines_of_pyvista_are_networks(fork: nx.Graph, fixtures: Path) -> None:
    nodes = np.array([fork.nodes[node]["pos"] for node in fork], float)
    lines = pyvista.PolyData(nodes, lines=[2, 0, 1, 2, 1, 2, 2, 1, 3])
    lines.point_data["radius"] = [fork.nodes[node]["radius"] for node in fork]
    mesh = anastomesh.mesh(fork)
    assert equal(anastomesh.mesh(lines), mesh)
    assert anastomesh.mesh(lines, roots=[2]).patches[1].node == 2
    lines.point_data["other"] = 2 * lines.point_data["radius"]
    assert anastomesh.mesh(lines, radius_array="other").patches[1].radius == 2
    assert anastomesh.render(lines, size=(80, 60)).startswith(b"\x89PNG")
    read: Any = pyvista.read(fixtures / "tree_30.vtp")
    assert equal(anastomesh.refine(read), anastomesh.refine(fixtures / "tree_30.vtp"))


def test_three_arrays(fork: nx.Graph) -> None:
    network = Network.of(fork)
    assert network.radii is not None
    mesh = anastomesh.mesh(network.nodes, network.edges, network.radii)
    assert equal(mesh, anastomesh.mesh(fork)) and equal(
        mesh, anastomesh.mesh(network.nodes.tolist(), network.edges.tolist(), [1, 1, 0.8, 0.8])
    )
    for function in (anastomesh.surface, anastomesh.refine, anastomesh.prepare, anastomesh.dual):
        made: Any = function(network.nodes, network.edges, network.radii)
        assert equal(made, function(fork))


def test_results_are_short_to_print(fork: nx.Graph) -> None:
    mesh = anastomesh.mesh(fork)
    assert repr(mesh).startswith(f"Mesh({len(mesh.points):,} points, {len(mesh.tets):,} tetrahedra, ")
    assert repr(Mesh(mesh.points, mesh.tets)).endswith("0 triangles, 0 patches)")
    assert repr(mesh.patches[1]) == "Patch(id=2, name='inlet')"


def test_version() -> None:
    said = subprocess.run([anastomesh.binary(), "--version"], capture_output=True, text=True, check=True).stdout
    assert said.split() == ["anastomesh", anastomesh.__version__]


def test_flow(fork: nx.Graph, tmp_path: Path) -> None:
    found = anastomesh.flow(fork, inflow=2.0, viscosity=1.0, output=tmp_path / "model.json")
    assert (found["vessels"], found["inlets"], found["outlets"], found["inflow"]) == (3, 1, 2, 2.0)
    table = found["table"]
    assert len(table["flow"]) == 3 and table["flow"].max() == pytest.approx(2.0)
    assert table["pressure_start"].max() == pytest.approx(found["largest_pressure"])
    assert anastomesh.info(tmp_path / "model.json")["nodes"] == 4
    branches = anastomesh.flow(fork, vessels="branches", stiffness=1e5, output=tmp_path / "model.in")
    assert len(branches["table"]["flow"]) == 3 and (tmp_path / "model.in").read_text().count("SEGMENT seg") == 3
    with pytest.raises(anastomesh.InputError, match="unrecognised result extension"):
        anastomesh.flow(fork, result=tmp_path / "model.json")
