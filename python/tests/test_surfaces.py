"""Tetrahedralization of surfaces, complexes and points."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import anastomesh
import numpy as np
import pytest
import pyvista
from conftest import Cube, volumes


def test_every_triangle_stays_as_it_is(cube: Cube) -> None:
    points, triangles = cube
    mesh = anastomesh.tetrahedralize(points, triangles)
    assert np.array_equal(mesh.points[:8], points)
    assert np.array_equal(mesh.triangles, triangles)
    assert volumes(mesh.points, mesh.tets).min() > 0
    assert volumes(mesh.points, mesh.tets).sum() == pytest.approx(1, rel=1e-12)
    assert mesh.report["report"]["mesh"]["tets"] == len(mesh.tets)
    assert anastomesh.check(mesh)


@pytest.mark.parametrize("kind", [np.float32, np.int64, ">f8"])
@pytest.mark.parametrize("corners", [np.int32, np.uint64, ">i2", np.uint8])
def test_arrays_of_any_kind_give_the_same_mesh(cube: Cube, kind: Any, corners: Any) -> None:
    points, triangles = cube
    usual = anastomesh.tetrahedralize(points, triangles, refine=False)
    other = anastomesh.tetrahedralize(np.asfortranarray(points.astype(kind)), triangles.astype(corners), refine=False)
    assert np.array_equal(usual.tets, other.tets)
    assert np.array_equal(usual.points, other.points)


def test_lists_do_as_well(cube: Cube) -> None:
    points, triangles = cube
    assert len(anastomesh.tetrahedralize(points.tolist(), triangles.tolist(), refine=False).tets) in (5, 6, 12)


def test_what_comes_back_is_the_callers(cube: Cube) -> None:
    mesh = anastomesh.tetrahedralize(*cube)
    assert type(mesh.points) is np.ndarray and mesh.points.dtype == np.float64
    assert mesh.tets.dtype == np.int32 and mesh.triangles.dtype == np.int32
    mesh.points[:] *= 2
    assert mesh.points.max() == 2


def test_markers_regions_holes_and_segments_of_a_complex(cube: Cube) -> None:
    points, triangles = cube
    inner = 0.25 + points / 2
    both = np.concatenate([points, inner])
    faces = np.concatenate([triangles, triangles + 8])
    markers = np.arange(24) - 5
    regions = [([0.1, 0.1, 0.1], 7), ([0.5, 0.5, 0.5], 9)]
    mesh = anastomesh.tetrahedralize(both, faces, plc=True, markers=markers, regions=regions, segments=[[0, 8]])
    assert mesh.regions is not None and mesh.markers is not None
    assert set(np.unique(mesh.regions)) == {7, 9}
    assert volumes(mesh.points, mesh.tets)[mesh.regions == 9].sum() == pytest.approx(1 / 8)
    by_face = {tuple(sorted(t)): m for t, m in zip(mesh.triangles.tolist(), mesh.markers.tolist(), strict=False)}
    assert [by_face[tuple(sorted(t))] for t in faces.tolist()] == markers.tolist()
    edges = {tuple(sorted(pair)) for t in mesh.tets.tolist() for pair in [(t[i], t[j]) for i in range(4) for j in range(i)]}
    assert (0, 8) in edges
    hollow = anastomesh.tetrahedralize(both, faces, plc=True, holes=[[0.5, 0.5, 0.5]])
    assert volumes(hollow.points, hollow.tets).sum() == pytest.approx(1 - 1 / 8)


def test_a_region_may_have_a_bound_on_its_volumes() -> None:
    sphere = pyvista.Icosphere(nsub=3)
    usual = anastomesh.tetrahedralize(sphere, plc=True, regions=[([0, 0, 0], 3)])
    bounded = anastomesh.tetrahedralize(sphere, plc=True, regions=[([0, 0, 0], 3, 5e-4)])
    of = [np.median(volumes(mesh.points, mesh.tets)) for mesh in (usual, bounded)]
    assert len(bounded.tets) > 1.5 * len(usual.tets) and of[1] < 5e-4 < volumes(usual.points, usual.tets).max()


def test_points_alone_become_their_delaunay_tetrahedra() -> None:
    points = np.random.default_rng(1).random((200, 3))
    mesh = anastomesh.tetrahedralize(points)
    assert len(mesh.points) == 200 and volumes(mesh.points, mesh.tets).min() > 0


def test_polydata_and_files(fixtures: Path) -> None:
    sphere = pyvista.Sphere()
    mesh = anastomesh.tetrahedralize(sphere, max_radius_edge=1.6)
    assert np.array_equal(mesh.triangles, sphere.regular_faces)
    assert len(anastomesh.tetrahedralize(fixtures / "torus.off").tets) > 1000
    with pytest.raises(ValueError, match="not triangles"):
        anastomesh.tetrahedralize(pyvista.Cube())


def test_a_bound_that_is_not_met_has_its_mesh(cube: Cube) -> None:
    with pytest.raises(anastomesh.InvalidError) as caught:
        anastomesh.tetrahedralize(*cube, max_volume=1e-5, tetgen=None, refine=True, size=10)
    error = caught.value
    assert [(condition.name, condition.count > 0) for condition in error.failed] == [("max_volume", True)]
    assert str(error).startswith(str(error.failed[0]))
    assert error.exit_code == 1
    assert anastomesh.check(error.result)
    assert error.report is not None and "report" in error.report
