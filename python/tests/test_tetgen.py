"""Drop-in replacement for TetGen of PyPI's tetgen."""

from __future__ import annotations

from pathlib import Path

import anastomesh
import numpy as np
import pytest
import pyvista
from conftest import Cube, volumes


def test_the_usual_call() -> None:
    sphere = pyvista.Sphere()
    tet = anastomesh.TetGen(sphere)
    nodes, elem, attributes, markers = tet.tetrahedralize(order=1, mindihedral=10, minratio=1.5, nobisect=True)
    assert np.array_equal(nodes[: sphere.n_points], sphere.points.astype(float))
    assert nodes is tet.node and elem is tet.elem and attributes.size == 0
    faces = np.sort(sphere.regular_faces, axis=1)
    assert np.array_equal(np.unique(np.sort(tet.trifaces, axis=1), axis=0), np.unique(faces, axis=0))
    assert len(markers) == len(faces)
    assert tet.grid.n_cells == len(elem) and tet.grid.volume == pytest.approx(volumes(nodes, elem).sum())
    assert tet.mesh.n_cells == sphere.n_cells
    assert len(tet.edges) == sphere.n_cells * 3 // 2


def test_by_default_the_boundary_may_be_split(cube: Cube) -> None:
    tet = anastomesh.TetGen(*cube)
    tet.tetrahedralize(minratio=1.2, maxvolume=0.005, mindihedral=10)
    assert len(tet.trifaces) > 12 and volumes(tet.node, tet.elem).max() <= 0.005


def test_switches_regions_and_holes(cube: Cube, tmp_path: Path) -> None:
    points, triangles = cube
    both = np.concatenate([points, 0.25 + points / 2])
    faces = np.concatenate([triangles, triangles + 8])
    tet = anastomesh.TetGen(both, faces)
    tet.add_region(4, [0.1, 0.1, 0.1])
    tet.add_region(5, (0.5, 0.5, 0.5), 0.002)
    _, _, attributes, _ = tet.tetrahedralize(switches="pYq1.4aA")
    assert set(attributes[:, 0]) == {4, 5} and set(tet.grid.cell_data["regions"]) == {4, 5}
    tet.write(tmp_path / "x.vtk")
    assert pyvista.read(tmp_path / "x.vtk").n_cells == len(tet.elem)
    hollow = anastomesh.TetGen(both, faces)
    hollow.add_hole([0.5, 0.5, 0.5])
    hollow.tetrahedralize(quality=False, nobisect=True)
    assert volumes(hollow.node, hollow.elem).sum() == pytest.approx(1 - 1 / 8)


def test_all_faces_and_edges(cube: Cube) -> None:
    tet = anastomesh.TetGen(*cube, np.arange(1, 13, dtype=np.int32))
    tet.tetrahedralize(quality=False, nobisect=True, facesout=True, edgesout=True)
    assert len(tet.trifaces) == (4 * len(tet.elem) + 12) // 2
    assert sorted(tet.triface_markers[tet.triface_markers > 0]) == list(range(1, 13))
    # Euler: points - edges + faces - tetrahedra of a ball.
    assert len(tet.node) - len(tet.edges) + len(tet.trifaces) - len(tet.elem) == 1


def test_what_is_not_there_is_refused(cube: Cube) -> None:
    tet = anastomesh.TetGen(*cube)
    with pytest.raises(AttributeError, match="no mesh yet"):
        _ = tet.grid
    assert not tet.is_tetrahedralized
    with pytest.raises(NotImplementedError, match="order=2 is not supported: use order=1, or anastomesh.tetrahedralize"):
        tet.tetrahedralize(order=2)
    with pytest.raises(NotImplementedError, match="bgmesh.*background mesh"):
        tet.tetrahedralize(bgmesh=pyvista.UnstructuredGrid())
    with pytest.raises(NotImplementedError, match="coarsen=True"):
        tet.tetrahedralize(coarsen=True)
    with pytest.raises(TypeError, match="unexpected keyword argument .mindiheral"):
        tet.tetrahedralize(mindiheral=3)  # type: ignore[call-arg]
    with pytest.raises(anastomesh.UsageError, match="R"):
        tet.tetrahedralize(switches="pR")
    # Keywords that tune TetGen are ignored, and so are defaults of refused ones.
    tet.tetrahedralize(nobisect=True, verbose=1, brio_ratio=0.5, coarsen=False, refine=False, bgmesh=None, steinerleft=-1)
    assert tet.is_tetrahedralized
    with pytest.raises(RuntimeError, match="all triangular"):
        anastomesh.TetGen(pyvista.Cube())


def test_a_surface_with_everything_twice_is_mended(cube: Cube) -> None:
    points, triangles = cube
    soup = points[triangles.ravel()]
    tet = anastomesh.TetGen(soup, np.arange(36).reshape(-1, 3))
    with pytest.raises(ValueError):
        tet.tetrahedralize(nobisect=True)
    tet.make_manifold()
    tet.tetrahedralize(nobisect=True)
    assert volumes(tet.node, tet.elem).sum() == pytest.approx(1)
