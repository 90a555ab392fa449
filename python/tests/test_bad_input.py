"""Input at fault is a ValueError that says which row."""

from __future__ import annotations

import os
import tempfile

import anastomesh
import numpy as np
import pytest
from anastomesh import Network

POINTS = np.eye(4)[:, :3]
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def with_row(array, row, values):
    array = np.array(array, dtype=np.result_type(array, np.asarray(values)))
    array[row] = values
    return array


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((POINTS[:, :2], TRIANGLES), r"points: has the shape \(4, 2\), and \(n, 3\) is needed"),
        ((POINTS.ravel(), TRIANGLES), r"points: has the shape \(12,\)"),
        ((POINTS, TRIANGLES[:, :2]), r"triangles: has the shape \(4, 2\)"),
        ((with_row(POINTS, 2, [0, np.nan, 0]), TRIANGLES), "points: row 2 is .*nan"),
        ((with_row(POINTS, 3, [0, np.inf, 0]), TRIANGLES), "points: row 3 is .*inf"),
        ((POINTS, with_row(TRIANGLES, 1, [0, 1, 4])), "triangles: row 1 names 4, but points has 4 rows"),
        ((POINTS, with_row(TRIANGLES, 3, [0, -1, 2])), "triangles: row 3 names -1"),
        ((POINTS, TRIANGLES.astype(float)), "triangles: has the dtype float64, and integers are needed"),
        ((POINTS.astype(complex), TRIANGLES), "points: has the dtype complex128"),
        ((POINTS.astype(str), TRIANGLES), "points: has the dtype"),
        ((POINTS.astype(object), TRIANGLES), "points: has the dtype object"),
        ((POINTS, TRIANGLES > 1), "triangles: has the dtype bool"),
        ((POINTS[:0], TRIANGLES[:0]), "no points|at least four points|nothing"),
        ((POINTS, TRIANGLES[:3]), "the surface is open"),
        ((POINTS[:, [0, 1, 0]] * 0, TRIANGLES), "."),
    ],
)
def test_surfaces(arguments, message):
    with pytest.raises(ValueError, match=message):
        anastomesh.tetrahedralize(*arguments)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"markers": [1, 2, 3]}, "markers: has 3 rows, and triangles has 4"),
        ({"markers": [1, 2, 3, 2**31]}, "markers: row 3 is 2147483648"),
        ({"segments": [[0, 9]]}, "segments: row 0 names 9"),
        ({"holes": [[0, 0]]}, r"holes: has the shape \(1, 2\)"),
        ({"regions": [([0, 0], 1)]}, "regions: row 0"),
        ({"regions": [([0, 0, 0], 1.5)], "plc": True}, "row 0"),
    ],
)
def test_what_goes_with_surfaces(options, message):
    with pytest.raises(ValueError, match=message):
        anastomesh.tetrahedralize(POINTS, TRIANGLES, **options)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([[0, 0], [1, 1]], [[0, 1]], [1, 1]), r"nodes: has the shape \(2, 2\)"),
        (([[0, 0, 0], [0, 0, 9]], [[0, 2]], [1, 1]), "edges: row 0 names 2, but nodes has 2 rows"),
        (([[0, 0, 0], [0, 0, 9]], [[0, 1]], [1]), "radii: has 1 rows, and nodes has 2"),
        (([[0, 0, 0], [0, 0, 9]], [[0, 1]], ["a", "b"]), "radii: has the dtype"),
        (([[0, 0, 0], [0, 0, 9]], [[0, 1]]), "give radii or edge_radii"),
        (([[0, 0, 0], [0, 0, 9]], [[0, 1]], None, [[1, 2, 3]]), "edge_radii: has the shape"),
    ],
)
def test_networks(arguments, message):
    with pytest.raises(ValueError, match=message):
        anastomesh.mesh(Network(*arguments))


def test_what_is_no_network_or_file():
    with pytest.raises(TypeError, match="a network is needed, not int"):
        anastomesh.mesh(3)
    with pytest.raises(anastomesh.InputError, match="No such file") as caught:
        anastomesh.mesh("/nowhere/network.vtp")
    assert isinstance(caught.value, ValueError) and caught.value.exit_code == 3


def test_options_that_there_are_not(fork):
    with pytest.raises(anastomesh.UsageError, match="--roh"):
        anastomesh.mesh(fork, roh=3)
    with pytest.raises(TypeError, match="rho"):
        anastomesh.mesh(fork, rho="thick")
    with pytest.raises(TypeError, match="output is not for the caller"):
        anastomesh.mesh(fork, output="x.vtu")
    with pytest.raises(TypeError, match="rho is <object"):
        anastomesh.mesh(fork, rho=object())
    with pytest.raises(TypeError, match="progress is 'yes'"):
        anastomesh.mesh(fork, progress="yes")


def test_nothing_is_left_behind(fork, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    mesh = anastomesh.mesh(fork)
    with pytest.raises(ValueError):
        anastomesh.tetrahedralize(POINTS, TRIANGLES[:3])
    assert os.listdir(tmp_path) == []
    assert mesh.points[mesh.tets].shape == (len(mesh.tets), 4, 3)


def test_a_mesh_at_fault(fork):
    mesh = anastomesh.mesh(fork)
    mesh.tets[5] = mesh.tets[5][[1, 0, 2, 3]]
    report = anastomesh.check(mesh)
    assert not report and [line["line"] for line in report.failed][0] == "positive_tets"
    mesh.tets[7, 2] = len(mesh.points)
    with pytest.raises(ValueError, match="tets: row 7 names"):
        anastomesh.check(mesh)
